"""The server of the page: viser, on the loopback interface by default."""

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

from jaxleas.types import InputError

if TYPE_CHECKING:
    from viser import ViserServer

LABEL = "jaxleas"


@contextmanager
def serving(host: str, port: int) -> "Iterator[ViserServer]":
    """Yield a running server; stop it at the end.

    Args:
        host: address to listen on; 127.0.0.1 can only be reached from this machine.
        port: port to listen on; 0 for any free port.

    Raises:
        InputError: viser is not installed, or the address cannot be listened on.
    """
    ViserServer = _viser_server()
    _require_free(host, port)
    with _silent():
        server = ViserServer(host=host, port=port, label=LABEL, verbose=False)
    try:
        if port not in (0, server.get_port()):  # viser silently takes the next port
            raise InputError(_in_use(host, port))
        # Viser can share a scene through its public server; here nothing leaves the machine.
        server.request_share_url = lambda verbose=True: None
        server.gui.configure_theme(
            show_logo=False, show_share_button=False, control_width="medium", dark_mode=False
        )
        yield server
    finally:
        with _silent():
            server.stop()


def address_of(server: "ViserServer") -> str:
    """Return the address of the page for a browser on this machine."""
    host = server.get_host()
    local = {"0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(host, f"[{host}]" if ":" in host else host)
    return f"http://{local}:{server.get_port()}"


def from_elsewhere(host: str, port: int) -> str:
    """Return a sentence on how other machines reach the page."""
    if host == "localhost" or host == "::1" or host.startswith("127."):
        there = f"[{host}]" if ":" in host else host
        return f"from elsewhere forward the port (ssh -L {port}:{there}:{port} THIS_MACHINE)"
    return "anyone who can reach this machine can open it, too: there is no password"


def open_browser(address: str) -> bool:
    """Show the page in a browser window; return whether one could be opened.

    A browser in the terminal would block the terminal, so on Linux a display is required.
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
    """Refuse an address that cannot be used, before anything is loaded or drawn."""
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
    except (OSError, UnicodeError) as error:  # UnicodeError: for a name that cannot be a host's
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
    """Suppress viser's banner on the terminal."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield
