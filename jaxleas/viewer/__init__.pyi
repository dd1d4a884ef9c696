from .ground import SKY_ABOVE as SKY_ABOVE
from .ground import SKY_BELOW as SKY_BELOW
