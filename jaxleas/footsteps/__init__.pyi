from .record_file import read_footsteps as read_footsteps
from .record_file import write_footsteps as write_footsteps
from .records import FootstepRecords as FootstepRecords
from .records import Footsteps as Footsteps
from .records import join_footsteps as join_footsteps
from .records import movement_of as movement_of
