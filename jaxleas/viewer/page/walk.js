// The steering task in JavaScript: terrain, observation, motion; it mirrors jaxleas/envs/steering.
// Metres, seconds, radians; the root's x points ahead, y left; a `task` is page.json.

const NO_GROUND = -1e4;

/** A height map: one height per cell, row = y, column = x; NaN = no ground. */
export class Terrain {
  constructor({ rows, columns, resolution, origin }, heights) {
    Object.assign(this, { rows, columns, resolution, origin, heights });
  }

  /** Height [m] of the cell that holds a point; far below everything where there is no ground. */
  heightAt(x, y) {
    const column = Math.floor((x - this.origin[0]) / this.resolution + 0.5);
    const row = Math.floor((y - this.origin[1]) / this.resolution + 0.5);
    if (row < 0 || row >= this.rows || column < 0 || column >= this.columns) return NO_GROUND;
    const height = this.heights[row * this.columns + column];
    return Number.isNaN(height) ? NO_GROUND : height;
  }
}

/** The root at rest at a place, at walking height. */
export function stand(task, terrain, [x, y], yaw = 0) {
  const position = [x, y, terrain.heightAt(x, y) + task.walking_height];
  return { position, velocity: [0, 0, 0], yaw };
}

/** The observation's grid points in the world, in its order: from the rear, from right to left. */
export function pointsSeen(task, { position, yaw }) {
  const [cosine, sine] = [Math.cos(yaw), Math.sin(yaw)];
  return task.observation.rows.flatMap((ahead) =>
    task.observation.columns.map((left) => [
      position[0] + cosine * ahead - sine * left,
      position[1] + sine * ahead + cosine * left,
    ]),
  );
}

/** What the policy sees: velocity in the root frame, angle to the goal, heights (T eq. 3.1). */
export function observe(task, terrain, motion, goal) {
  const { position, velocity, yaw } = motion;
  const [low, high] = task.observation.height_clip;
  const heights = pointsSeen(task, motion).map(([x, y]) =>
    Math.min(high, Math.max(low, terrain.heightAt(x, y) - position[2])),
  );
  const bearing = Math.atan2(goal[1] - position[1], goal[0] - position[0]);
  return Float32Array.from([...turned(velocity, -yaw), wrapped(bearing - yaw), ...heights]);
}

/** The root one time step later, under an acceleration in the root frame and a turn rate (T eq. 3.3). */
export function integrate(task, { position, velocity, yaw }, command) {
  const { time_step: step, max_speed: limit } = task.command;
  const acceleration = turned(command.slice(0, 3), yaw);
  const faster = velocity.map((each, axis) => each + acceleration[axis] * step);
  const excess = Math.max(1, Math.hypot(...faster) / limit);
  return {
    position: position.map((each, axis) => each + velocity[axis] * step),
    velocity: faster.map((each) => each / excess),
    yaw: wrapped(yaw + command[3] * step),
  };
}

/** One time step of a policy: an onnxruntime session; `ort` is its library. */
export async function step(ort, session, task, terrain, motion, goal) {
  const observation = observe(task, terrain, motion, goal);
  const input = new ort.Tensor("float32", observation, [1, observation.length]);
  const { command } = await session.run({ observation: input });
  return guarded(task, terrain, motion, integrate(task, motion, Array.from(command.data)));
}

/**
 * The motion that is asked for, without its turn, upwards or downwards alone, or braking: the first
 * that can stop in time.
 */
export function guarded(task, terrain, motion, asked) {
  if (!task.guard) return asked;
  const room = Math.min(0, margin(task, terrain, motion, "spared"));
  if (canStop(task, terrain, room, asked)) return asked;
  const straight = { ...asked, yaw: motion.yaw };
  if (canStop(task, terrain, room, straight)) return straight;
  const upright = { ...straight, velocity: upwards(task, motion.velocity, asked.velocity[2]) };
  if (canStop(task, terrain, room, upright)) return upright;
  return { ...straight, velocity: slower(task, motion.velocity) };
}

/** The velocity one time step later, towards a vertical one. */
function upwards(task, velocity, rising) {
  const { max_acceleration: most, time_step: step } = task.command;
  const change = [-velocity[0], -velocity[1], rising - velocity[2]];
  const share = Math.min(1, (most * step) / Math.max(Math.hypot(...change), 1e-12));
  return velocity.map((each, axis) => each + share * change[axis]);
}

/** Whether the root is valid here and wherever it would be while it braked to rest. */
function canStop(task, terrain, room, { position, velocity, yaw }) {
  for (;;) {
    const now = { position, yaw };
    const isValid = margin(task, terrain, now, "valid") >= 0;
    if (!isValid || !(margin(task, terrain, now, "spared") >= room)) return false;
    if (!velocity.some((each) => each !== 0)) return true;
    position = position.map((each, axis) => each + velocity[axis] * task.command.time_step);
    velocity = slower(task, velocity);
  }
}

/** The margin [m] of the guard's conditions ("valid"), or of those with room to spare ("spared"). */
function margin({ guard }, terrain, { position, yaw }, which) {
  const height = (index) => {
    const [x, y] = turned([...guard.points[index], 0], yaw);
    return terrain.heightAt(position[0] + x, position[1] + y) - position[2];
  };
  const reach = guard[which].reach.map(([index, low, high]) =>
    Math.min(height(index) - low, high - height(index)),
  );
  const free = guard[which].free.map(([index, bottom]) => bottom - height(index));
  return Math.min(Math.max(...reach), ...free);
}

function slower(task, velocity) {
  const { max_acceleration: braking, time_step: step } = task.command;
  const speed = Math.hypot(...velocity);
  return velocity.map((each) => (speed > braking * step ? each * (1 - (braking * step) / speed) : 0));
}

export function distance([x, y], goal) {
  return Math.hypot(goal[0] - x, goal[1] - y);
}

export function wrapped(angle) {
  return angle - 2 * Math.PI * Math.floor((angle + Math.PI) / (2 * Math.PI));
}

function turned([x, y, z], yaw) {
  const [cosine, sine] = [Math.cos(yaw), Math.sin(yaw)];
  return [x * cosine - y * sine, x * sine + y * cosine, z];
}
