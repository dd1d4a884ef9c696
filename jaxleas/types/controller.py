"""Identity of a walking controller: what its footsteps and models are those of."""

from dataclasses import dataclass, field, fields

from jaxleas.types.errors import InputError

MOVEMENTS = ("forward", "left", "right", "clockwise", "counter-clockwise")
"""Movements that a controller is asked for; each has one non-zero entry of the command."""
NOT_STATED = "not stated"


@dataclass(frozen=True)
class ControllerIdentity:
    """A walking controller that takes velocity commands, as its users see it.

    Two controllers are the same if all of this is the same: footsteps and models of one do not
    serve the other.

    Attributes:
        name: name of the controller, such as "trot".
        robot: name of the robot, such as "anymal_b".
        feet: names of the effectors, in the order of every array of feet.
        pairs: indices of the feet that swing together, in the order in which they follow each
            other: ((0, 3), (1, 2)) is a trot of LF, RF, LH, RH.
        swing_height: height of the apex of a swing above lift-off [m].
        foot_radius: radius of a foot [m].
        max_speeds: largest speeds that are commanded: forward and sideways [m/s], turning [rad/s].
        settings: every other setting that changes how it walks, by name.
    """

    name: str
    robot: str
    feet: tuple[str, ...]
    pairs: tuple[tuple[int, ...], ...]
    swing_height: float
    foot_radius: float
    max_speeds: tuple[float, float, float]
    settings: dict[str, float | str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        swinging = sorted(foot for pair in self.pairs for foot in pair)
        if len(set(self.feet)) != len(self.feet) or swinging != list(range(len(self.feet))):
            raise InputError(
                f"the pairs {self.pairs} of controller {self.name} must hold each of its"
                f" {len(self.feet)} feet once"
            )
        if not (self.swing_height > 0 and self.foot_radius > 0 and min(self.max_speeds) >= 0):
            raise InputError(
                f"controller {self.name}: swing height and foot radius must be positive, and no"
                " largest speed negative"
            )

    @property
    def pair_names(self) -> tuple[str, ...]:
        """Names of the pairs, such as "LF/RH"."""
        return tuple("/".join(self.feet[foot] for foot in pair) for pair in self.pairs)

    def require_same(self, other: "ControllerIdentity", where: str, needed_by: str) -> None:
        """Refuse another controller.

        Args:
            other: identity found.
            where: what the identity was found in, for the message.
            needed_by: what needs this identity, for the message.

        Raises:
            InputError: the identities differ; the message says in what.
        """
        if differences := self._differences(other):
            raise InputError(
                f"{where} is of another controller than {needed_by}: {'; '.join(differences)}"
            )

    def _differences(self, other: "ControllerIdentity") -> list[str]:
        mine, found = _flat(self), _flat(other)
        return [
            f"{name}: {found.get(name, NOT_STATED)} instead of {mine.get(name, NOT_STATED)}"
            for name in mine | found
            if mine.get(name) != found.get(name)
        ]


def _flat(identity: ControllerIdentity) -> dict[str, object]:
    """Return the entries of an identity by name, those of its settings among them."""
    entries: dict[str, object] = {
        each.name: getattr(identity, each.name)
        for each in fields(identity)
        if each.name != "settings"
    }
    return entries | {f"settings.{name}": value for name, value in identity.settings.items()}
