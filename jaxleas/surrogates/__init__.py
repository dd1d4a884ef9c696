"""A contact planner's learned stand-in: features, network, fit, calibration; as a condition."""

from jaxleas.surrogates.fit import fit, foreseen_failure
from jaxleas.surrogates.foresight import SurrogateForesight
from jaxleas.surrogates.label_files import Labels, read_labels
from jaxleas.surrogates.settings import FitSettings
from jaxleas.surrogates.surrogate import Identity, Surrogate
from jaxleas.surrogates.surrogate_file import read_surrogate, require_fit, write_surrogate
from jaxleas.surrogates.walks import LabelledWalks, join, label_walks

__all__ = [
    "FitSettings",
    "Identity",
    "LabelledWalks",
    "Labels",
    "Surrogate",
    "SurrogateForesight",
    "fit",
    "foreseen_failure",
    "join",
    "label_walks",
    "read_labels",
    "read_surrogate",
    "require_fit",
    "write_surrogate",
]
