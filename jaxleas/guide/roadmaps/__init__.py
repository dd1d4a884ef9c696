"""Roadmaps: waypoints for any steering method, searched by RRT or PRM (T sec. 3.1.1, 3.4.1)."""

from jaxleas.guide.places import Places
from jaxleas.guide.roadmaps.budget import Budget
from jaxleas.guide.roadmaps.navigation import Navigation, Navigator, PlannerName

__all__ = ["Budget", "Navigation", "Navigator", "Places", "PlannerName"]
