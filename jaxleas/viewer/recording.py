"""Recordings of the page as one self-contained HTML file."""

from typing import TYPE_CHECKING, Any

from jaxleas.types import InputError

if TYPE_CHECKING:
    from viser import ViserServer

FILE_NAME = "jaxleas_recording.html"
MOST_SECONDS = 600.0  # longest recording: it is kept in memory until it is saved


class Recorder:
    """A recorder of the page from `start` to `finish`."""

    def __init__(self, server: "ViserServer") -> None:
        self._server = server
        self._scene: Any = None
        self._seconds = 0.0

    @property
    def recording(self) -> bool:
        """Whether a recording is in progress."""
        return self._scene is not None

    def start(self) -> None:
        """Begin a recording with the current scene."""
        self._scene, self._seconds = self._server.get_scene_serializer(), 0.0

    def frame(self, seconds: float) -> None:
        """Advance the recording; what comes after its longest time is not kept."""
        if self.recording and self._seconds < MOST_SECONDS:
            self._scene.insert_sleep(seconds)
            self._seconds += seconds

    def finish(self) -> str:
        """Return the recording as a self-contained HTML page.

        Raises:
            InputError: nothing is being recorded.
        """
        if not self.recording:
            raise InputError("nothing is being recorded: start a recording first")
        scene, self._scene = self._scene, None
        return scene.as_html()

    def add_panel(self) -> None:
        """Add a button that starts a recording, then saves it through the browser."""
        button = self._server.gui.add_button("Record")

        @button.on_click
        def _(event: Any) -> None:
            if not self.recording:
                self.start()
                button.label = "Save the recording"
                return
            page = self.finish()
            button.label = "Record"
            event.client.send_file_download(FILE_NAME, page.encode(), save_immediately=True)
