"""Export: a policy as ONNX and StableHLO files, checked against JAX before they are written."""

from jaxleas.export.errors import ExportError
from jaxleas.export.onnx_file import build_onnx
from jaxleas.export.parity import TOLERANCE, largest_difference
from jaxleas.export.recording import record_observations
from jaxleas.export.stablehlo import read_stablehlo, to_stablehlo
from jaxleas.export.write import export_policy

__all__ = [
    "TOLERANCE",
    "ExportError",
    "build_onnx",
    "export_policy",
    "largest_difference",
    "read_stablehlo",
    "record_observations",
    "to_stablehlo",
]
