// The page: draws the terrain from above, and lets the policy walk where one clicks.

import * as ort from "./ort.wasm.bundle.min.mjs";
import { Terrain, distance, pointsSeen, stand, step, wrapped } from "./walk.js";

const SLOWEST = 0.02; // [m/s]: slower for `PATIENCE` seconds means that it will not go on
const PATIENCE = 10;
const canvas = document.getElementById("map");
const pen = canvas.getContext("2d");

const { task, terrain, session } = await load();
const picture = draw(terrain);
let before, motion, goal, trail, clock, since, state;
begin();
requestAnimationFrame(frame);

async function load() {
  const found = async (name) => {
    const answer = await fetch(name);
    if (!answer.ok) throw new Error(`${name}: ${answer.status}`);
    return answer;
  };
  try {
    ort.env.wasm.numThreads = 1; // more would need headers that static hosts do not send
    const [task, heights, session] = await Promise.all([
      found("page.json").then((answer) => answer.json()),
      found("heights.bin").then((answer) => answer.arrayBuffer()),
      ort.InferenceSession.create("policy.onnx", { executionProviders: ["wasm"] }),
    ]);
    return { task, session, terrain: new Terrain(task.terrain, new Float32Array(heights)) };
  } catch (problem) {
    say(`The policy cannot be loaded: ${problem.message}`);
    throw problem;
  }
}

function begin() {
  motion = before = stand(task, terrain, task.start.position, task.start.yaw);
  [goal, trail, clock, since] = [null, [motion.position], 0, 0];
  change("waiting", "It waits for a goal.");
}

function send(place) {
  goal = place;
  since = 0;
  change("walking", "It walks.");
}

/** One picture; and the steps that its time asks for, one after another. */
let last = performance.now();
async function frame(now) {
  const seconds = Math.min(0.1, (now - last) / 1000) * document.getElementById("speed").valueAsNumber;
  last = now;
  const interval = task.command.time_step;
  for (clock += state === "walking" ? seconds : 0; clock >= interval; clock -= interval) {
    const was = motion;
    const next = await step(ort, session, task, terrain, was, goal);
    if (was !== motion || state !== "walking") break; // the user began again meanwhile
    [before, motion] = [was, next];
    trail.push(motion.position);
    since = Math.hypot(...motion.velocity) < SLOWEST ? since + interval : 0;
    if (distance(motion.position, goal) <= task.goal_radius) halt("arrived", "It has arrived.");
    else if (since > PATIENCE) halt("stopped", "It stops: it sees no way on.");
  }
  show(state === "walking" ? clock / interval : 1);
  requestAnimationFrame(frame);
}

function halt(name, words) {
  before = motion = { ...motion, velocity: [0, 0, 0] };
  clock = 0;
  change(name, words);
}

function change(name, words) {
  state = document.body.dataset.state = name;
  say(words);
}

function say(words) {
  document.getElementById("status").textContent = words;
}

// ---- pictures

/** The height map as an image, north up: bright is high, light comes from the upper left. */
function draw({ rows, columns, resolution, heights }) {
  const ground = [...heights].filter((each) => !Number.isNaN(each)).sort((a, b) => a - b);
  const low = ground[0];
  const span = Math.max(ground[Math.floor(0.97 * (ground.length - 1))] - low, 0.3);
  const image = new ImageData(columns, rows);
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const at = row * columns + column;
      if (Number.isNaN(heights[at])) continue;
      const west = heights[row * columns + Math.max(column - 1, 0)];
      const north = heights[Math.min(row + 1, rows - 1) * columns + column];
      const slope = (heights[at] - west + (heights[at] - north)) / resolution;
      const light = Number.isNaN(slope) ? 0 : Math.max(-1, Math.min(1, slope / 3));
      const share = Math.min(1, (heights[at] - low) / span);
      const colour = [92 + 122 * share, 104 + 96 * share, 118 + 52 * share];
      const pixel = 4 * ((rows - 1 - row) * columns + column);
      image.data.set(colour.map((each) => each + 30 * light), pixel);
      image.data[pixel + 3] = 255;
    }
  }
  const whole = new OffscreenCanvas(columns, rows);
  whole.getContext("2d").putImageData(image, 0, 0);
  return whole;
}

function pixelsPerMetre() {
  return canvas.width / (terrain.columns * terrain.resolution);
}

/** Draw in metres from here on: x to the right, y up. */
function useMetres() {
  const scale = pixelsPerMetre();
  const [x, y] = terrain.origin.map((each) => each - 0.5 * terrain.resolution);
  pen.setTransform(scale, 0, 0, -scale, -x * scale, canvas.height + y * scale);
}

function show(share) {
  const width = canvas.clientWidth * devicePixelRatio;
  const height = (width * terrain.rows) / terrain.columns;
  if (canvas.width !== Math.round(width)) [canvas.width, canvas.height] = [width, height];
  pen.setTransform(1, 0, 0, 1, 0, 0);
  pen.clearRect(0, 0, canvas.width, canvas.height);
  pen.imageSmoothingEnabled = false;
  pen.drawImage(picture, 0, 0, canvas.width, canvas.height);
  useMetres();
  const position = motion.position.map((end, axis) => mix(before.position[axis], end, share));
  const yaw = before.yaw + share * wrapped(motion.yaw - before.yaw);
  showSeen({ position, yaw });
  showTrail(position);
  if (goal) showGoal();
  showRobot(position, yaw);
}

function showSeen(pose) {
  const [low, high] = task.observation.height_clip;
  for (const [x, y] of pointsSeen(task, pose)) {
    const height = terrain.heightAt(x, y) - pose.position[2];
    const share = Math.min(1, Math.max(0, (height - low) / (high - low)));
    pen.fillStyle = `hsl(${260 - 210 * share} 75% 60%)`;
    dot(x, y, 0.017);
  }
}

function showTrail(position) {
  pen.strokeStyle = "#1d6fb8";
  pen.lineWidth = 0.03;
  pen.lineJoin = "round";
  pen.beginPath();
  for (const [x, y] of [...trail.slice(0, -1), position]) pen.lineTo(x, y);
  pen.stroke();
}

function showGoal() {
  pen.strokeStyle = "#1e9c4a";
  pen.lineWidth = 0.035;
  pen.beginPath();
  pen.arc(...goal, task.goal_radius, 0, 2 * Math.PI);
  pen.stroke();
  pen.fillStyle = "#1e9c4a";
  dot(...goal, 0.05);
}

/** The trunk's shadow, and a wedge that points ahead. */
function showRobot([x, y], yaw) {
  const [[rear, right], [front, left]] = task.trunk;
  pen.save();
  pen.translate(x, y);
  pen.rotate(yaw);
  pen.fillStyle = "#e0701a";
  pen.strokeStyle = "white";
  pen.lineWidth = 0.02;
  pen.beginPath();
  pen.roundRect(rear, right, front - rear, left - right, 0.06);
  pen.fill();
  pen.stroke();
  pen.fillStyle = "white";
  pen.beginPath();
  pen.moveTo(front - 0.02, 0);
  pen.lineTo(front - 0.14, 0.09);
  pen.lineTo(front - 0.14, -0.09);
  pen.fill();
  pen.restore();
}

function dot(x, y, radius) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
}

function mix(from, to, share) {
  return from + share * (to - from);
}

// ---- people

canvas.addEventListener("pointerdown", (event) => {
  const scale = (terrain.columns * terrain.resolution) / canvas.clientWidth;
  const [x, y] = terrain.origin.map((each) => each - 0.5 * terrain.resolution);
  send([x + event.offsetX * scale, y + (canvas.clientHeight - event.offsetY) * scale]);
});
document.getElementById("again").addEventListener("click", begin);
