"""A small valid file of every kind, and who reads it."""

import contextlib
import json
import random
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import yaml
from PIL import Image

from benchmarks.strangers import mutations as m
from benchmarks.strangers.mutations import Mutation
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.layout import layout_named
from jaxleas.terrain import Scene, write_height_map, write_scene
from jaxleas.terrain.rasterise import rasterise


@dataclass(frozen=True)
class Kind:
    """One kind of file.

    Attributes:
        name: for people.
        file: its path below the folder it lives in.
        read: what jaxleas does with that path.
        mutate: knows what it holds.
        companions: further files that it needs, by path below the folder.
    """

    name: str
    file: str
    content: bytes
    read: Callable[[Path], Any]
    mutate: Mutation
    companions: dict[str, bytes]

    def mutated(self, draw: random.Random, others: "list[Kind]") -> bytes:
        """Return what a stranger might send."""
        chance = draw.random()
        if chance < 0.55:
            # Mutations of mutations may nest deeper than Python's own writers go.
            with contextlib.suppress(RecursionError):
                return self.mutate(draw, self.content)
        if chance < 0.9:
            return m.mutate_bytes(draw, self.content)
        if chance < 0.95:
            return m.splice(draw, self.content, draw.choice(others).content)
        return draw.choice(others).content


def floor() -> Scene:
    """Return two surfaces, an obstacle and an area."""
    square = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]
    step = [[2, 0, 0.1], [3, 0, 0.1], [3, 1, 0.1], [2, 1, 0.1]]
    top = [[0.5, 0.2, 0.8], [0.8, 0.2, 0.8], [0.8, 0.5, 0.8], [0.5, 0.5, 0.8]]
    area = [[0, 0], [1, 0], [1, 1], [0, 1]]
    as_arrays = lambda group: {name: np.array(each, float) for name, each in group.items()}  # noqa: E731
    return Scene(
        as_arrays({"floor": square, "step": step}),
        as_arrays({"box_top": top}),
        as_arrays({"a": area}),
    )


def make_corpus(folder: Path) -> list[Kind]:
    """Write the valid files below a folder, with the package's own writers, and read them back."""
    folder.mkdir(parents=True, exist_ok=True)
    return [
        *_terrains(folder),
        *_guides(folder),
        *_learned(folder),
        *_contacts(folder),
        *_runs(folder),
    ]


def _kind(
    name: str,
    path: Path,
    read: Callable[[Path], Any],
    mutate: Mutation,
    *beside: Path,
    at: str = "",
) -> Kind:
    companions = {each.name: each.read_bytes() for each in beside}
    return Kind(name, at or path.name, path.read_bytes(), read, mutate, companions)


def _terrains(folder: Path) -> list[Kind]:
    from jaxleas.terrain import import_png, import_terrain
    from jaxleas.terrain.mesh_scene import mesh_to_scene

    scene = floor()
    write_scene(folder / "scene.json", scene)
    write_height_map(folder / "heights.npz", rasterise(scene, 0.1))
    values = np.random.default_rng(0).integers(1, 65536, size=(9, 12)).astype(np.uint16)
    Image.fromarray(values).save(folder / "grey.png")
    corners = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0.2], [0, 1, 0.2], [1, 2, 0.1]], np.float32)
    faces = [[0, 1, 2], [0, 2, 3], [3, 2, 4]]
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    triangles = np.zeros(len(faces), record)
    triangles["corners"] = corners[faces]
    head = b"made by nobody".ljust(80) + np.uint32(len(faces)).tobytes()
    (folder / "binary.stl").write_bytes(head + triangles.tobytes())
    text = "".join(
        "facet normal 0 0 1\nouter loop\n"
        + "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners[face])
        + "endloop\nendfacet\n"
        for face in faces
    )
    (folder / "text.stl").write_text(f"solid x\n{text}endsolid x\n")
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + ["f 1 2 3 4", "f 4/1/1 3//2 5"]
    (folder / "mesh.obj").write_text("# a mesh\nmtllib x.mtl\nvt 0 0\n" + "\n".join(lines) + "\n")

    def mesh(path: Path) -> None:
        import_terrain(path, resolution=0.5)
        mesh_to_scene(path)

    return [
        _kind("height map", folder / "heights.npz", import_terrain, m.mutate_npz),
        _kind(
            "scene", folder / "scene.json", partial(import_terrain, resolution=0.5), m.mutate_json
        ),
        _kind("binary STL", folder / "binary.stl", mesh, m.mutate_stl),
        _kind("text STL", folder / "text.stl", mesh, m.mutate_text),
        _kind("OBJ", folder / "mesh.obj", mesh, m.mutate_text),
        _kind(
            "PNG",
            folder / "grey.png",
            partial(import_png, resolution=0.1, z_min=0.0, z_max=1.0),
            m.mutate_png,
        ),
    ]


def _guides(folder: Path) -> list[Kind]:
    from jaxleas.contacts.guide_file import read_guide_path
    from jaxleas.guide.files import read_queries, write_guide_paths
    from jaxleas.labels.label import plan_shards
    from jaxleas.labels.shards import read_verdicts, write_shard
    from jaxleas.labels.verdict import Verdict
    from jaxleas.surrogates.label_files import read_labels
    from jaxleas.types import GuidePath
    from jaxleas.viewer.clips import read_guide_clips

    query = {"position": [0.5, 0.5, 0.95], "yaw": 0.0, "velocity": [0, 0, 0], "goal": [2.5, 0.5]}
    (folder / "queries.json").write_text(json.dumps([query, query]))
    rows = 30
    path = GuidePath(
        time=0.2 * np.arange(rows),
        position=np.column_stack([np.linspace(0.3, 1.5, rows), np.full((rows, 2), [0.5, 0.95])]),
        yaw=np.zeros(rows),
        velocity=np.zeros((rows, 3)),
        valid=np.ones(rows, bool),
    )
    write_guide_paths(folder / "guides.npz", [path, path], ["reached", "stopped"])
    scene, guides = folder / "scene.json", folder / "guides.npz"
    (shard,) = plan_shards([guides], scene, "sampling", None, folder / "labels")
    verdict = Verdict(
        *(0, True, True, 29, 30, 1.0, 4, 0.2, 0, 10.0, 12.0, None, None, "", 0.1),
    )
    fields = verdict.__dict__
    write_shard(shard, [verdict, Verdict(**(fields | {"path": 1, "success": False}))])

    def guides_read(path: Path) -> None:
        read_guide_clips(path)
        read_guide_path(path)

    def labels_read(path: Path) -> None:
        read_verdicts(path.parent)
        read_labels([path.parent], [], 0.2)

    return [
        _kind("queries", folder / "queries.json", read_queries, m.mutate_json),
        _kind("guide paths", guides, guides_read, m.mutate_npz),
        _kind("verdicts", shard.out, labels_read, m.mutate_json, scene, guides),
    ]


def _learned(folder: Path) -> list[Kind]:
    from jaxleas.envs.steering import SteeringEnv
    from jaxleas.export.onnx_file import build_onnx
    from jaxleas.guide.loading import load_policy
    from jaxleas.guide.onnx_metadata import describe
    from jaxleas.surrogates import Identity, Surrogate, read_surrogate, write_surrogate
    from jaxleas.surrogates.features import MOTION_FEATURES
    from jaxleas.surrogates.network import Weights
    from jaxleas.training.checkpoints import Checkpoints
    from jaxleas.training.policy import SteeringPolicy, write_policy

    config = SteeringConfig(observation="icra81")
    size, generator = layout_named(config.observation).size, np.random.default_rng(0)

    def some(*shape: int) -> jax.Array:
        return jnp.asarray(generator.normal(size=shape), jnp.float32)

    policy = SteeringPolicy(
        mean=some(size),
        deviation=jnp.ones(size),
        kernels=(some(size, 6), some(6, 8)),
        biases=(some(6), some(8)),
        activation="relu",
        config=config,
    )
    write_policy(folder / "policy.npz", policy)
    (folder / "policy.onnx").write_bytes(build_onnx(policy, describe(config)))
    inputs, code, hidden = len(SteeringEnv(config).points_in_root) + MOTION_FEATURES, 5, 4
    weights = Weights(
        encoder=some(inputs, code),
        encoder_bias=some(code),
        gates=some(code + hidden, 2 * hidden),
        gates_bias=some(2 * hidden),
        candidate=some(code + hidden, hidden),
        candidate_bias=some(hidden),
        head=some(hidden),
        head_bias=some(),
    )
    identity = Identity(
        planner="sampling",
        parameters={"keep_every": 5, "samples": 100},
        robot=config.robot,
        observation=config.observation,
        height_low=config.height_low,
        height_high=config.height_high,
    )
    write_surrogate(
        folder / "surrogate.npz",
        Surrogate(weights, jnp.ones(()), jnp.zeros(()), identity, {"guides": {}}),
    )
    state = {
        "key": jax.random.key(0),
        "w": some(3, 2),
        "n": 3,
        "rate": 0.5,
        "half": some(2).astype(jnp.bfloat16),
    }
    checkpoints = Checkpoints(folder / "checkpoints")
    checkpoints.save(7, state, {"best": 0.5}, 0.5)
    (step,) = (folder / "checkpoints").glob("step_*.npz")

    def walk(path: Path) -> None:
        load_policy(path)(np.zeros((2, size), np.float32))

    def restore(path: Path) -> None:
        found = Checkpoints(path.parent)
        found.latest(state)
        found.best(state)

    return [
        _kind("policy", folder / "policy.npz", walk, m.mutate_npz),
        _kind("ONNX policy", folder / "policy.onnx", walk, m.mutate_onnx),
        _kind("surrogate", folder / "surrogate.npz", read_surrogate, m.mutate_npz),
        _kind("checkpoint", step, restore, m.mutate_npz),
    ]


def _contacts(folder: Path) -> list[Kind]:
    from jaxleas.contacts.plan import ContactPlan, read_plan, write_plan
    from jaxleas.contacts.posture import Posture
    from jaxleas.contacts.problem import FootPose
    from jaxleas.contacts.problem_file import read_problem, write_problem
    from jaxleas.robots.files import read_robot
    from jaxleas.robots.legs import read_legs
    from jaxleas.viewer.clips import read_plan_clip

    surfaces = {"floor": [[0, -1, 0], [4, -1, 0], [4, 1, 0], [0, 1, 0]]}
    problem = {
        "version": 1,
        "robot": "talos",
        "model": "two_com",
        "surfaces": surfaces,
        "initial": {
            "LF": {"position": [1, 0.1, 0], "yaw": 0.0},
            "RF": {"position": [1, -0.1, 0], "yaw": 0.0},
        },
        "phases": [
            {"foot": "RF", "yaw": 0.0, "candidates": ["floor"], "root": [1.2, 0, 0.95]},
            {"foot": "LF", "yaw": 0.0, "candidates": ["floor"], "root": [1.4, 0, 0.95]},
        ],
    }
    (folder / "raw_problem.json").write_text(json.dumps(problem))
    write_problem(folder / "problem.json", read_problem(folder / "raw_problem.json"))
    feet = {foot: FootPose(np.array([1.0, 0.1, 0.0]), 0.0) for foot in ("LF", "RF")}
    posture = Posture(0, "start", None, feet, {"LF": "floor", "RF": "floor"}, np.zeros(3))
    plan = ContactPlan(
        planner="mip",
        feasible=True,
        status="feasible",
        surfaces=("floor", "floor"),
        footholds=np.array([[1.3, -0.1, 0], [1.5, 0.1, 0]]),
        com=np.zeros((2, 2, 3)),
        max_violation=0.0,
        robustness=(1.0,),
        postures=(posture,),
    )
    write_plan(folder / "plan.json", plan)
    asked = folder / "problem.json"
    data = Path(__file__).resolve().parents[2] / "jaxleas" / "robots" / "data"

    def plan_read(path: Path) -> None:
        read_plan(path)
        read_plan_clip(path, path.with_name("problem.json"))

    return [
        _kind("contact problem", folder / "problem.json", read_problem, m.mutate_json),
        _kind("contact plan", folder / "plan.json", plan_read, m.mutate_json, asked),
        _kind("robot", data / "talos.json", read_robot, m.mutate_json),
        _kind("legs", data / "talos_legs.json", read_legs, m.mutate_json),
    ]


def _runs(folder: Path) -> list[Kind]:
    from jaxleas.distillation.config import DistillationConfig
    from jaxleas.distillation.judging import read_judged
    from jaxleas.evaluation.result_file import (
        CellResult,
        Evaluation,
        read_evaluation,
        write_evaluation,
    )
    from jaxleas.training.config import RunConfig
    from jaxleas.training.configuration import load_config, to_yaml
    from jaxleas.training.metrics import read_metrics
    from jaxleas.training.run_folder import RunFolder

    text = to_yaml(RunConfig())
    # The generator's many numbers would be most of it, and reading them most of the time.
    (folder / "config.yaml").write_text(
        text[: text.index("terrain:")] + text[text.index("network:") :]
    )
    (folder / "base.yaml").write_text(yaml.safe_dump({"ppo": {"steps": 1000}, "seed": 3}))
    (folder / "extending.yaml").write_text("extends: base.yaml\nppo: {discount: 0.9}\n")
    (folder / "distil.yaml").write_text("planner: mip\nparameters: {keep_every: 3}\nrounds: 2\n")
    row = {"step": 10, "seconds": 0.5, "walk/reward": 1.5, "held_out/reached": None}
    (folder / "metrics.jsonl").write_text("".join(json.dumps(row) + "\n" for _ in range(3)))
    (folder / "provenance.json").write_text(
        json.dumps({"format": 1, "jaxleas": "0.1", "git": None})
    )
    shares = {"reached": 0.9, "invalid": 0.1, "stopped": 0.0, "low": 0.6, "high": 0.98}
    cell = CellResult.model_validate(
        {"name": "bridge", "yaw": 0.0, "method": "leas_p1", "starts": 10} | shares
    )
    evaluation = Evaluation(
        suite="transitions", policy="x", robot="talos", seed=0, created="2026", cells=(cell,)
    )
    write_evaluation(folder / "evaluation.json", evaluation)
    (folder / "judged.json").write_text(
        json.dumps({"version": 1, "cells": [cell.model_dump(mode="json")]})
    )

    def opened(path: Path) -> None:
        RunFolder.open(path.parent, needs_checkpoint=False)

    run_config = partial(load_config, RunConfig)
    return [
        _kind("configuration", folder / "config.yaml", run_config, m.mutate_yaml),
        _kind(
            "extending configuration",
            folder / "extending.yaml",
            run_config,
            m.mutate_yaml,
            folder / "base.yaml",
        ),
        _kind(
            "distillation configuration",
            folder / "distil.yaml",
            partial(load_config, DistillationConfig),
            m.mutate_yaml,
        ),
        _kind("metrics", folder / "metrics.jsonl", read_metrics, m.mutate_lines),
        _kind(
            "run folder", folder / "provenance.json", opened, m.mutate_json, folder / "config.yaml"
        ),
        _kind("evaluation", folder / "evaluation.json", read_evaluation, m.mutate_json),
        _kind("judged round", folder / "judged.json", read_judged, m.mutate_json),
    ]
