"""The server behind the page: viser, on the loopback interface unless told otherwise."""

import contextlib
import errno
import io
import os
import socket
import sys
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from jaxleas.types.errors import InputError

if TYPE_CHECKING:
    from viser import ViserServer

LABEL = "jaxleas"


@contextmanager
def serving(host: str, port: int) -> "Iterator[ViserServer]":
    """Yield a running server; stop it at the end.

    Args:
        host: address to listen on; 127.0.0.1 is reached from this machine alone.
        port: to listen on; 0 for any that is free.

    Raises:
        InputError: viser is not installed, or nobody can listen there.
    """
    ViserServer = _viser_server()
    _require_free(host, port)
    with _silent():
        server = ViserServer(host=host, port=port, label=LABEL, verbose=False)
    try:
        if port not in (0, server.get_port()):  # viser takes the next one without a word
            raise InputError(_in_use(host, port))
        # Viser can pass a scene on through a server of its own; here nothing leaves the machine.
        server.request_share_url = lambda verbose=True: None
        server.gui.configure_theme(
            show_logo=False, show_share_button=False, control_width="medium", dark_mode=False
        )
        yield server
    finally:
        with _silent():
            server.stop()


def address_of(server: "ViserServer") -> str:
    """Return what to type into a browser on this machine."""
    host = server.get_host()
    local = {"0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(host, f"[{host}]" if ":" in host else host)
    return f"http://{local}:{server.get_port()}"


def from_elsewhere(host: str, port: int) -> str:
    """Say how, or that, other machines reach the page."""
    if host == "localhost" or host == "::1" or host.startswith("127."):
        there = f"[{host}]" if ":" in host else host
        return f"from elsewhere forward the port (ssh -L {port}:{there}:{port} THIS_MACHINE)"
    return "whoever reaches this machine can open it, too: there is no password"


def open_browser(address: str) -> bool:
    """Show the page in a browser window; return whether there is one to show it in.

    A browser in the terminal would take the terminal away, so on Linux a display is asked for.
    """
    has_window = sys.platform in ("darwin", "win32") or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )
    if not has_window:
        return False
    try:
        return webbrowser.open(address)
    except (webbrowser.Error, OSError):
        return False


def _viser_server() -> "type[ViserServer]":
    try:
        from viser import ViserServer
    except ImportError as error:
        raise InputError(
            "the viewer needs viser, which is not installed: pip install 'jaxleas[view]'"
        ) from error
    return ViserServer


def _require_free(host: str, port: int) -> None:
    """Refuse an address that cannot be listened on, before anything is loaded or drawn."""
    if not 0 <= port <= 65535:
        raise InputError(f"--port {port} is no port: give 0 (any free one) to 65535")
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        with socket.socket(family, kind, protocol) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
            probe.listen(1)
    except (OSError, UnicodeError) as error:  # the latter of a name that can be no host's
        if getattr(error, "errno", None) == errno.EADDRINUSE:
            raise InputError(_in_use(host, port)) from error
        raise InputError(
            f"cannot listen on {host!r}, port {port}: {getattr(error, 'strerror', None) or error};"
            " --host 127.0.0.1 is usual, with a --port above 1023"
        ) from error


def _in_use(host: str, port: int) -> str:
    return (
        f"port {port} of {host} is in use: end what listens there, or give another --port"
        " (0: any that is free)"
    )


@contextmanager
def _silent() -> Iterator[None]:
    """Keep viser's banner off the terminal."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield
