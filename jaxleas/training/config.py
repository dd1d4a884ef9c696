"""What a training run is told: one frozen section a room, and the whole."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from jaxleas.configuration.bounds import Count, Fraction, NonNegative, Positive, Seed
from jaxleas.configuration.strict import Strict
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.own_files import Entry as TerrainEntry
from jaxleas.terrain.seeds import MAX_TRAINING_SEED


class LinkShares(Strict):
    """How often an episode begins at a link of each kind, relative to the others.

    Left to chance half of the links would be level ground, and one in ten a narrow bridge, which
    takes the longest to learn.
    """

    bridge: NonNegative = 0.35
    stairs_up: NonNegative = 0.20
    stairs_down: NonNegative = 0.20
    rubble: NonNegative = 0.10
    obstacles: NonNegative = 0.12
    flat: NonNegative = 0.03
    detour: NonNegative = 0.0
    """Holes and walls to be walked round (terrain.generator.detour_probability makes them)."""
    cliff: NonNegative = 0.0
    """A goal too high up or too far down: stop. With a share of 0.1 policies also stopped before
    stairs; random goals teach enough of stopping."""
    void: NonNegative = 0.0
    """A goal where there is no ground: stop; likewise."""


class TerrainConfig(Strict):
    """The arenas that are trained on."""

    arenas: Count = 64
    """Number of random arenas in the atlas."""
    resolution: Annotated[float, Field(ge=0.01, le=0.2)] = 0.04
    """Side of a height map's cell [m]."""
    first_seed: Annotated[int, Field(ge=0, le=MAX_TRAINING_SEED)] = 0
    """Arena i is generated from seed first_seed + i; evaluation uses seeds beyond these."""
    shares: LinkShares = LinkShares()
    generator: GeneratorConfig = GeneratorConfig()
    files: tuple[TerrainEntry, ...] = ()
    """Terrain files of one's own to train on beside the generator's arenas: paths, or
    `{file: PATH, up: y, scale: 0.001}` with what a file does not say of itself. They train, they
    never judge."""
    files_share: Fraction = 0.0
    """Share of the starts that fall on these files, each as often as any other."""

    @model_validator(mode="after")
    def _files_have_a_share(self) -> Self:
        if self.files and not self.files_share:
            raise ValueError("files are given, but files_share is 0: give a share, such as 0.5")
        if self.files_share and not self.files:
            raise ValueError(
                f"files_share is {self.files_share:g}, but no files are given: give files, too"
            )
        return self


class NetworkConfig(Strict):
    """Actor and critic, two distinct networks (T sec. 3.4)."""

    hidden: tuple[Count, ...] = (128, 64, 32)
    """Sizes of the hidden layers."""
    activation: Literal["relu", "tanh", "swish", "elu"] = "relu"
    normaliser: Literal["affine", "running"] = "affine"
    """`affine`: fixed, from the observation's bounds; `running`: Brax's running statistics."""
    products: Literal["float32", "bfloat16", "auto"] = "float32"
    """In what numbers training multiplies matrices and keeps what lies between layers: `auto` is
    `bfloat16` where the device has units for it (GPUs, processors with AMX), `float32` elsewhere.
    Weights, sums, and what is judged and exported are float32 all the same."""

    @property
    def product_type(self) -> Literal["float32", "bfloat16"]:
        """In what numbers this machine multiplies."""
        if self.products != "auto":
            return self.products
        from jaxleas.xla.matrix_units import native_products  # asks JAX for its devices

        return native_products()


class PpoConfig(Strict):
    """Proximal policy optimisation."""

    steps: Count = 6_000_000
    """Environment steps of the whole training."""
    environments: Count = 2048
    """Robots that walk at once."""
    unroll: Count = 20
    """Steps each robot takes between two policy updates."""
    minibatches: Count = 16
    epochs: Count = 4
    """Passes over each batch."""
    learning_rate: Positive = 5e-4
    """At the start; it falls linearly (T sec. 3.4)."""
    final_learning_rate: NonNegative = 1e-5
    discount: Fraction = 0.99
    """gamma: about 100 steps, 2 m, of foresight. The thesis's 0.97 sees 66 cm: too little for a
    step aside to a bridge to pay in time, and policies stood still in front of it."""
    gae_lambda: Fraction = 0.95
    clip: Positive = 0.2
    entropy: NonNegative = 0.003
    value_weight: NonNegative = 0.5
    reward_scale: Positive = 0.1
    final_failure: NonNegative = 60.0
    """env.reward.failure grows linearly to this. At first falling must be cheap, or nobody dares to
    set foot on a bridge; in the end it must be dear, or turning while walking backwards towards an
    edge pays although one in ten falls."""
    max_gradient_norm: Positive = 1.0
    mirror: bool = True
    """Learn from each batch's mirror image as often as from the batch itself."""
    averaging: Fraction = 0.99
    """Decay per update of the exponential average of the policy that is judged and exported."""
    candidates: Count = 1024
    """Fresh starts drawn before each update."""

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
    """A start that has not reached its goal by then has failed."""


class CheckpointsConfig(Strict):
    """Which of the states written at every examination are kept."""

    keep_last: Count = 2
    """The newest; the best by held-out success is always kept, too."""


class FinalConfig(Strict):
    """What follows training: the verdict, the artifacts and the report."""

    evaluate: bool = True
    """Judge the best policy on the evaluation suites, export it and write the report."""
    starts: Count = 1000
    """Starts a cell of the transitions suite."""


class RunConfig(Strict):
    """One experiment."""

    seed: Seed = 0
    """Of everything random in training except the terrain."""
    watch: tuple[Literal["tensorboard", "wandb", "mlflow"], ...] = ("tensorboard",)
    """Who is told the metrics, beside metrics.jsonl; wandb and mlflow are extras."""
    terrain: TerrainConfig = TerrainConfig()
    env: SteeringConfig = SteeringConfig()
    network: NetworkConfig = NetworkConfig()
    ppo: PpoConfig = PpoConfig()
    held_out: HeldOutConfig = HeldOutConfig()
    checkpoints: CheckpointsConfig = CheckpointsConfig()
    final: FinalConfig = FinalConfig()
