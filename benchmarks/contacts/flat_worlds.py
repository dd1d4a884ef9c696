"""Contact problems on level rectangles with boxes of steps, whose answers are known by hand."""

REACH = {  # a box: 0.3 m forwards and backwards, 0.15 to 0.4 m aside, 0.2 m up and down
    "A": [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
    "RF_in_LF": [0.3, 0.3, -0.15, 0.4, 0.2, 0.2],
    "LF_in_RF": [0.3, 0.3, 0.4, -0.15, 0.2, 0.2],
    "COM": [0.4, 0.4, 0.4, 0.4, 1.0, -0.6],
}


def boxes(step: float = 0.3, rise: float = 0.2) -> dict:
    """Return step polytopes that are boxes."""
    polytopes = {}
    for name in ("RF_in_LF", "LF_in_RF", "COM_in_LF", "COM_in_RF"):
        bound = list(REACH["COM" if name.startswith("COM") else name])
        if not name.startswith("COM"):
            bound[0] = bound[1] = step
            bound[4] = bound[5] = rise
        polytopes[name] = {"A": REACH["A"], "b": bound}
    return polytopes


def rectangle(x0: float, x1: float, y0: float, y1: float, z: float = 0.0) -> list[list[float]]:
    """Return a level rectangle."""
    return [[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]]


def content(
    surfaces: dict[str, list[list[float]]],
    candidates: list[list[str]],
    model: str = "two_com",
    **changes,
) -> dict:
    """Return the content of a contact problem's file, from feet at (0, +-0.1), left foot first."""
    feet = ("LF", "RF")
    return {
        "robot": "talos",
        "model": model,
        "surfaces": surfaces,
        "initial": {
            "LF": {"position": [0.0, 0.1, 0.0], "yaw": 0.0},
            "RF": {"position": [0.0, -0.1, 0.0], "yaw": 0.0},
        },
        "phases": [
            {"foot": feet[index % 2], "yaw": 0.0, "candidates": names, "root": None}
            for index, names in enumerate(candidates)
        ],
        "polytopes": boxes(),
        "foot_half_size": [0.1, 0.06],
        **changes,
    }
