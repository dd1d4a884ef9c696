"""`jaxleas fit` fits as every other fit does."""

import inspect

from jaxleas.distillation.config import DistillationConfig
from jaxleas.surrogates import FitSettings
from jaxleas.surrogates.commands import fit


def test_an_option_that_is_left_out_has_the_default_of_the_fit_itself():
    options = inspect.signature(fit).parameters
    shared = {name: each.default for name, each in options.items()}.items()
    usual = FitSettings().model_dump()
    given = {name: default for name, default in shared if name in usual}
    assert given.keys() == {"epochs", "code", "hidden", "seed"}
    assert given == {name: usual[name] for name in given}
    assert DistillationConfig().fit == FitSettings(**given)
