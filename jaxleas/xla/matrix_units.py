"""The number type that the training device multiplies fastest without harm to learning."""

from functools import cache
from pathlib import Path
from typing import Any, Literal

import jax

ProductType = Literal["float32", "bfloat16"]
CPUINFO = Path("/proc/cpuinfo")


@cache
def native_products() -> ProductType:
    """Return bfloat16 if the training device has units that multiply it, else float32."""
    device = jax.devices()[0]
    fit = has_matrix_units(CPUINFO) if device.platform == "cpu" else multiplies_bfloat16(device)
    return "bfloat16" if fit else "float32"


def has_matrix_units(cpuinfo: Path) -> bool:
    """Return whether a processor has AMX for bfloat16, as Linux lists its features.

    Without it, XLA computes such products via float32, more slowly than float32 products.
    """
    try:
        text = cpuinfo.read_text(encoding="utf-8")
    except OSError:  # another operating system, where it is unknown
        return False
    return any("amx_bf16" in line.split() for line in text.splitlines() if line[:5] == "flags")


def multiplies_bfloat16(device: Any) -> bool:
    """Return whether an accelerator multiplies bfloat16; GPUs before Ampere (8.0) do not."""
    capability = getattr(device, "compute_capability", None)
    return capability is None or float(capability) >= 8.0
