"""Guide paths: steering methods, and the roll-outs in which they walk."""

from jaxleas.guide.files import (
    GuidePathFile,
    read_guide_paths,
    read_queries,
    require_on_terrain,
    write_guide_paths,
)
from jaxleas.guide.leas import Leas, leas
from jaxleas.guide.loading import load_policy
from jaxleas.guide.onnx_policy import OnnxPolicy, read_onnx_policy
from jaxleas.guide.rb_kino import RbKino, rb_kino
from jaxleas.guide.rb_lin import RbLin, rb_lin
from jaxleas.guide.registry import Edges, Method
from jaxleas.guide.rollout import RollOut, Trips, paths, roll_out
from jaxleas.guide.steering_method import HostSteeringMethod, SteeringMethod

__all__ = [
    "Edges",
    "GuidePathFile",
    "HostSteeringMethod",
    "Leas",
    "Method",
    "OnnxPolicy",
    "RbKino",
    "RbLin",
    "RollOut",
    "SteeringMethod",
    "Trips",
    "leas",
    "load_policy",
    "paths",
    "rb_kino",
    "rb_lin",
    "read_guide_paths",
    "read_onnx_policy",
    "read_queries",
    "require_on_terrain",
    "roll_out",
    "write_guide_paths",
]
