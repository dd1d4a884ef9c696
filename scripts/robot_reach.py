"""Where soles and the centre of mass can be: samples of leg configurations, and their hulls."""

import itertools

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # its wheel adds a .pth
from robot_recipe import Recipe
from scipy.spatial import ConvexHull, HalfspaceIntersection

from jaxleas.geometry import Box, Polytope
from jaxleas.robots import Body, LimbModel, chain_posture, read_chain

LEAST_KNEE_BEND = 0.4  # [rad]; nearer to straight the leg cannot carry the root along
LEAST_KNEE_BEND_OF_COM = 0.2  # [rad]; the same, where the centre of mass is looked for
MOST_TILT = np.deg2rad(15.0)
CLEARANCE = 0.02  # between the sole and the trunk's bottom [m]
SIMPLIFIED_WITHIN = 0.005  # [m]
SAMPLES_AT_ONCE = 200_000
PLACED_AT_ONCE = 4_000  # their frames stay in a core's cache: more than twice as fast
MIRROR = np.array([1.0, -1.0, 1.0])


def sample_configurations(recipe: Recipe, samples: int, seed: int) -> np.ndarray:
    """Draw leg configurations uniformly within the joint limits [rad]."""
    low = recipe.chain.lower.copy()
    low[recipe.knee] = max(low[recipe.knee], LEAST_KNEE_BEND)
    drawn = np.random.default_rng(seed)
    return drawn.uniform(low, recipe.chain.upper, (samples, len(low)))


def sample_soles(recipe: Recipe, samples: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Draw configurations and place their soles."""
    return place_soles(recipe, sample_configurations(recipe, samples, seed))


def place_soles(recipe: Recipe, configurations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the middle [m] and the upward normal of each sole in the root frame."""
    middles, normals = np.empty((len(configurations), 3)), np.empty((len(configurations), 3))
    for start in range(0, len(configurations), PLACED_AT_ONCE):
        some = slice(start, start + PLACED_AT_ONCE)
        posture = chain_posture(recipe.chain, configurations[some])
        middles[some], normals[some] = posture.tip, posture.tip_rotation[:, :, 2]
    return middles, normals


def keep_standing(recipe: Recipe, soles: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Tell which soles could stand on walkable ground with the root upright."""
    flat = normals[:, 2] >= np.cos(MOST_TILT)
    below = soles[:, 2] <= recipe.trunk_bottom - CLEARANCE
    own_side = soles[:, 1] >= -recipe.half_size[1]
    x, y = recipe.reach
    return flat & below & own_side & (np.abs(soles[:, 0]) <= x) & (soles[:, 1] <= y)


def standing_legs(recipe: Recipe, samples: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return left-leg configurations that stand, and their soles in the root frame."""
    kept = []
    for chunk in range(max(1, samples // SAMPLES_AT_ONCE)):
        drawn = sample_configurations(recipe, min(samples, SAMPLES_AT_ONCE), seed + chunk)
        soles, normals = place_soles(recipe, drawn)
        keep = keep_standing(recipe, soles, normals)
        kept.append((drawn[keep], soles[keep]))
    return np.concatenate([a for a, _ in kept]), np.concatenate([b for _, b in kept])


def step_polytope(recipe: Recipe, soles: np.ndarray) -> Polytope:
    """Return where the right foot can be from the left one such that one root reaches both.

    The differences of the corners of the two legs' hulls (their Minkowski difference, hence
    convex), cut to the longest step and to feet that do not stand on each other.
    """
    left = soles[ConvexHull(soles).vertices]
    differences = (left[:, None, :] * MIRROR - left[None, :, :]).reshape(-1, 3)
    sides = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0]])
    ahead, apart = recipe.step
    cut = Polytope.from_points(differences).cut(sides, np.array([ahead, ahead, -apart]))
    return Polytope.from_points(cut.vertices)


def sample_com(
    recipe: Recipe, legs: np.ndarray, soles: np.ndarray, step: Polytope, pairs: int, seed: int
) -> np.ndarray:
    """Return centres of mass from the left foot, over random pairs of legs that make a step.

    Masses are the URDF's, the arms in the neutral posture.
    """
    rng = np.random.default_rng(seed)
    left, right = rng.integers(len(legs), size=(2, 4 * pairs))
    allowed = step.contains(soles[right] * MIRROR - soles[left])
    left, right = left[allowed][:pairs], right[allowed][:pairs]
    data, whole = recipe.model.createData(), pin.neutral(recipe.model)
    other = read_chain(recipe.path, recipe.root, recipe.feet[1])
    columns = recipe.columns(recipe.chain), recipe.columns(other)
    points = np.zeros((len(left), 3))
    for index, (one, two) in enumerate(zip(left, right, strict=True)):
        whole[columns[0]] = legs[one]
        whole[columns[1]] = legs[two] * recipe.chain.mirror_signs
        points[index] = pin.centerOfMass(recipe.model, data, whole) - soles[one]
    return points


def com_in_foot(recipe: Recipe, leg: LimbModel, body: Body, samples: int, seed: int) -> Polytope:
    """Return the hull of the reference centre of mass in the frame of a standing left foot.

    The frame is turned by the foot's yaw alone; the hull is simplified from outside to 26 faces:
    along the axes, between two and between three of them.
    """
    lower = leg.chain.lower.copy()
    lower[recipe.knee] = max(lower[recipe.knee], LEAST_KNEE_BEND_OF_COM)
    angles = np.random.default_rng(seed).uniform(lower, leg.chain.upper, (samples, len(lower)))
    posture = leg.posture(angles)
    level = posture.tip_rotation[:, 2, 2] >= np.cos(MOST_TILT)
    below = posture.tip[:, 2] <= -0.4 * recipe.root_height / 1.0198
    keep = level & below & (posture.tip[:, 1] >= -recipe.half_size[1])
    rotation, sole = posture.tip_rotation[keep], posture.tip[keep]
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
    x, y, z = (reference_com(leg, body) - sole).T
    cosine, sine = np.cos(yaw), np.sin(yaw)
    seen = np.stack([cosine * x + sine * y, cosine * y - sine * x, z], axis=1)
    corners = seen[ConvexHull(seen).vertices]
    ways = [way for way in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(way)]
    normals = np.array(ways) / np.linalg.norm(ways, axis=1, keepdims=True)
    return rounded(Polytope(normals, (corners @ normals.T).max(axis=0)))


def reference_com(leg: LimbModel, body: Body) -> np.ndarray:
    """Return the whole robot's centre of mass in the root frame, standing."""
    standing = leg.posture(leg.reference)
    moment = leg.mass_moment(standing.frames, standing.origins)
    mass = body.mass + 2.0 * float(leg.link_mass.sum())
    return (body.mass * body.com + moment + moment * MIRROR) / mass


def simplify(hull: Polytope, corners: np.ndarray) -> Polytope:
    """Return fewer faces around `hull`: no corner further than 5 mm outside, nothing cut off."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    simple = Polytope.from_box(Box(tuple(low), tuple(high)))
    middle = corners.mean(axis=0)
    while True:
        halfspaces = np.concatenate([simple.normals, -simple.offsets[:, None]], axis=1)
        outer = HalfspaceIntersection(halfspaces, middle).intersections
        outside = outer @ hull.normals.T - hull.offsets
        worst, face = np.unravel_index(np.argmax(outside), outside.shape)
        if outside[worst, face] <= SIMPLIFIED_WITHIN:
            return simple
        simple = simple.cut(hull.normals[face : face + 1], hull.offsets[face : face + 1])


def rounded(polytope: Polytope) -> Polytope:
    """Round for a readable file: normals to 1e-6, offsets up to the next 1e-5 m."""
    return Polytope(np.round(polytope.normals, 6) + 0.0, np.ceil(polytope.offsets * 1e5) / 1e5)
