"""Contacts, the stances they make, and the durations of stances."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Self

import numpy as np

from jaxleas.types.errors import InputError
from jaxleas.types.poses import Pose


@dataclass(frozen=True, eq=False)
class Contact:
    """The contact of one effector with one surface.

    Attributes:
        effector: name of the robot's effector, such as "LF".
        surface: name of the contact surface.
        pose: pose of the effector's frame in the world; its third axis is the contact normal, away
            from the surface.
    """

    effector: str
    surface: str
    pose: Pose

    def __post_init__(self) -> None:
        if not self.effector:
            raise InputError("a contact needs the name of its effector")
        if self.pose.position.shape != (3,):
            raise InputError(
                f"a contact needs one pose, not a batch of shape {self.pose.position.shape[:-1]}"
            )

    @property
    def normal(self) -> np.ndarray:
        """The contact normal in the world."""
        return self.pose.rotation[:, 2]

    def is_at(self, other: "Contact", within: float = 1e-9) -> bool:
        """Return whether two contacts are the same one.

        Args:
            other: contact to compare with.
            within: accepted difference of a coordinate [m] and of a quaternion's entry [1].
        """
        same = self.effector == other.effector and self.surface == other.surface
        apart = float(np.abs(self.pose.position - other.pose.position).max())
        turns = np.stack([other.pose.quaternion, -other.pose.quaternion]) - self.pose.quaternion
        return same and apart <= within and float(np.abs(turns).max(axis=1).min()) <= within


@dataclass(frozen=True, eq=False)
class Stance:
    """The set of contacts that a robot has at one time, none or one for each effector.

    Attributes:
        contacts: contact of each effector that has one, by the effector's name.
    """

    contacts: Mapping[str, Contact]

    def __post_init__(self) -> None:
        for name, contact in self.contacts.items():
            if contact.effector != name:
                raise InputError(f"the contact of '{contact.effector}' is listed under '{name}'")
        object.__setattr__(self, "contacts", MappingProxyType(dict(self.contacts)))

    @classmethod
    def of(cls, contacts: Iterable[Contact]) -> Self:
        """Return the stance with given contacts.

        Raises:
            InputError: two contacts belong to one effector.
        """
        listed = tuple(contacts)
        named = {contact.effector: contact for contact in listed}
        if len(named) < len(listed):
            raise InputError("a stance holds at most one contact of each effector")
        return cls(named)

    def __len__(self) -> int:
        """Return the number of contacts."""
        return len(self.contacts)

    def __contains__(self, effector: object) -> bool:
        """Return whether an effector has a contact."""
        return effector in self.contacts

    def __getitem__(self, effector: str) -> Contact:
        """Return the contact of an effector.

        Raises:
            InputError: the effector has no contact.
        """
        if effector not in self.contacts:
            having = ", ".join(self.contacts) or "no effector"
            raise InputError(f"effector '{effector}' has no contact in this stance; {having} has")
        return self.contacts[effector]

    def making(self, contact: Contact) -> "Stance":
        """Return the stance with one contact made, or moved where its effector has one."""
        return Stance({**self.contacts, contact.effector: contact})

    def breaking(self, effector: str) -> "Stance":
        """Return the stance without the contact of an effector.

        Raises:
            InputError: the effector has no contact.
        """
        broken = self[effector].effector
        return Stance({name: each for name, each in self.contacts.items() if name != broken})

    def changed(self, after: "Stance", within: float = 1e-9) -> tuple[str, ...]:
        """Return the effectors whose contacts were made, moved or broken until a later stance.

        Args:
            after: later stance.
            within: accepted difference of a coordinate [m] and of a quaternion's entry [1].
        """
        names = dict.fromkeys([*self.contacts, *after.contacts])
        return tuple(
            name
            for name in names
            if (name in self) != (name in after) or not self[name].is_at(after[name], within)
        )


@dataclass(frozen=True, eq=False)
class SupportPhase:
    """A stance that does not change for a period of time.

    Attributes:
        stance: contacts during the phase.
        duration: length of the phase [s].

    Raises:
        InputError: the duration is not a positive number.
    """

    stance: Stance
    duration: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.duration) and self.duration > 0.0):
            raise InputError(f"a support phase lasts a positive time [s], not {self.duration!r}")
