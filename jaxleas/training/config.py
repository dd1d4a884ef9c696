"""The configuration of a training run: one frozen section per room, and the whole."""

from collections.abc import Mapping
from typing import Annotated, Generic, Literal, Self, TypeVar

from pydantic import Field, model_validator

from jaxleas.configuration import Count, Fraction, NonNegative, Positive, Seed, Strict
from jaxleas.envs import TaskConfig, WorldsConfig


class MapsConfig(Strict):
    """The encoder that each map of an observation gets (network.kind: maps)."""

    channels: Annotated[tuple[Count, ...], Field(min_length=1, max_length=16)] = (16, 32, 32)
    """Channels of each convolution; each halves the map's sides."""
    kernels: Annotated[tuple[Count, ...], Field(min_length=1, max_length=16)] = (5, 3, 3)
    """Side of each convolution's kernel."""
    latent: Count = 64
    """Length of the vector into which a map is encoded."""

    @model_validator(mode="after")
    def _as_many(self) -> Self:
        if len(self.channels) != len(self.kernels):
            raise ValueError(
                f"channels = {list(self.channels)} and kernels = {list(self.kernels)} must be as"
                " long as each other"
            )
        return self


class NetworkConfig(Strict):
    """Actor and critic, two distinct networks (T sec. 3.4)."""

    kind: Literal["mlp", "maps"] = "mlp"
    """`mlp`: a perceptron over the whole observation; `maps`: maps of the observation go through
    convolutions first."""
    maps: MapsConfig = MapsConfig()
    hidden: tuple[Count, ...] = (128, 64, 32)
    """Sizes of the hidden layers."""
    activation: Literal["relu", "tanh", "swish", "elu"] = "relu"
    normaliser: Literal["affine", "running"] = "affine"
    """`affine`: fixed, from the observation's bounds; `running`: Brax's running statistics."""
    products: Literal["float32", "bfloat16", "auto"] = "float32"
    """Number type in which training multiplies matrices and keeps values between layers: `auto`
    is `bfloat16` where the device has units for it (GPUs, processors with AMX), else `float32`.
    Weights, sums, and what is judged and exported are always float32."""

    @property
    def product_type(self) -> Literal["float32", "bfloat16"]:
        """Number type in which this machine multiplies."""
        if self.products != "auto":
            return self.products
        from jaxleas.xla import native_products

        return native_products()


class PpoConfig(Strict):
    """Proximal policy optimisation."""

    steps: Count = 6_000_000
    """Environment steps of the whole training."""
    environments: Count = 2048
    """Robots that walk at the same time."""
    unroll: Count = 20
    """Steps each robot takes between two policy updates."""
    minibatches: Count = 16
    epochs: Count = 4
    """Passes over each batch."""
    learning_rate: Positive = 5e-4
    """Learning rate at the start; it falls linearly (T sec. 3.4)."""
    final_learning_rate: NonNegative = 1e-5
    discount: Fraction = 0.99
    """gamma: about 100 steps, 2 m, of foresight. The thesis's 0.97 sees 66 cm: too little for a
    step aside to a bridge to pay in time, and policies stood still in front of it."""
    gae_lambda: Fraction = 0.95
    clip: Positive = 0.2
    entropy: NonNegative = 0.003
    value_weight: NonNegative = 0.5
    reward_scale: Positive = 0.1
    max_gradient_norm: Positive = 1.0
    mirror: bool = True
    """Learn from each batch's mirror image as often as from the batch itself."""
    averaging: Fraction = 0.99
    """Decay per update of the exponential average of the policy that is judged and exported."""
    candidates: Count = 1024
    """Fresh starts drawn before each update."""
    failure_starts: Fraction = 0.0
    """Share of the fresh starts that are taken from the candidates in proportion to how often
    episodes of their group failed lately; the others are taken evenly."""

    @property
    def batch(self) -> int:
        """Environment steps between two policy updates."""
        return self.environments * self.unroll

    @property
    def updates(self) -> int:
        """Policy updates of the whole training."""
        return -(-self.steps // self.batch)

    @model_validator(mode="after")
    def _divisible(self) -> Self:
        if self.environments % self.minibatches:
            raise ValueError(
                f"minibatches = {self.minibatches} does not divide environments ="
                f" {self.environments}: a minibatch is a whole number of robots"
            )
        return self


class HeldOutConfig(Strict):
    """The small examination during training, on terrain that is never trained on."""

    every: Count = 10
    """Policy updates between two examinations (and checkpoints)."""
    starts: Count = 1024
    arenas: Count = 16
    steps: Count = 500
    """Time limit [steps]: a start that has not reached its goal by then has failed."""


class CheckpointsConfig(Strict):
    """Which of the states written at every examination are kept."""

    keep_last: Count = 2
    """Number of newest checkpoints to keep; the best by held-out success is always kept, too."""


class FinalConfig(Strict):
    """What follows training: the evaluation, the artifacts and the report."""

    evaluate: bool = True
    """Judge the best policy on the evaluation suites, export it and write the report."""
    starts: Count = 1000
    """Starts per cell of the transitions suite."""


Env = TypeVar("Env", bound=TaskConfig)
Worlds = TypeVar("Worlds", bound=WorldsConfig)


class RunConfig(Strict, Generic[Env, Worlds]):
    """One experiment; `RunConfig[task.Config, task.Worlds]` is that of one task."""

    seed: Seed = 0
    """Seed of everything random in training except the terrain."""
    begin: str = ""
    """Policy file whose actor the training begins with, beside an untrained critic; none where
    empty. A resumed run continues its own."""
    watch: tuple[Literal["tensorboard", "wandb", "mlflow"], ...] = ("tensorboard",)
    """Watchers that receive the metrics, besides metrics.jsonl; wandb and mlflow are extras."""
    # A section that is left out takes its defaults, of the type that the task prescribes.
    terrain: Worlds = Field(default_factory=dict, validate_default=True)  # type: ignore[assignment]
    env: Env = Field(default_factory=dict, validate_default=True)  # type: ignore[assignment]
    network: NetworkConfig = NetworkConfig()
    ppo: PpoConfig = PpoConfig()
    held_out: HeldOutConfig = HeldOutConfig()
    checkpoints: CheckpointsConfig = CheckpointsConfig()
    final: FinalConfig = FinalConfig()

    @classmethod
    def former_names(cls) -> Mapping[str, str]:
        """Return the former names of fields, which the task's files may still use."""
        return getattr(cls.model_fields["env"].annotation, "moved", {})
