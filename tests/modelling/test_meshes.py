"""Meshes of URDFs: where they are found, and how COLLADA files are read."""

import numpy as np
import pytest

from jaxleas.modelling.collada import read_collada
from jaxleas.modelling.mesh_search import MeshSearch
from jaxleas.types import InputError

DAE = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema">
<asset><unit meter="0.01"/><up_axis>{up}</up_axis></asset>
<library_geometries><geometry id="bar"><mesh>
<source id="places"><float_array count="9">0 0 0 {x} 0 0 0 3 0</float_array></source>
<vertices id="corners"><input semantic="POSITION" source="#places"/></vertices>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="scene"><node id="outer"><translate>1 2 3</translate>
<node id="inner"><rotate>0 0 1 90</rotate><instance_geometry url="#bar"/></node></node>
</visual_scene></library_visual_scenes></COLLADA>"""


@pytest.mark.parametrize(
    ("up", "places"),
    [
        # The triangle turned by a quarter about z, moved by (1, 2, 3), in centimetres.
        ("Z_UP", [[1, 2, 3], [1, 4, 3], [-2, 2, 3]]),
        ("Y_UP", [[1, -3, 2], [1, -3, 4], [-2, -3, 2]]),
    ],
)
def test_a_collada_scene_places_its_geometries(tmp_path, up, places):
    path = tmp_path / "bar.dae"
    path.write_text(DAE.format(up=up, x=2))
    np.testing.assert_allclose(read_collada(path), 0.01 * np.array(places), atol=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "<COLLADA",
        "<!DOCTYPE x><COLLADA/>",
        DAE.format(up="W_UP", x=2),
        DAE.format(up="Z_UP", x="a"),
    ],
)
def test_a_damaged_collada_file_is_refused(tmp_path, text):
    path = tmp_path / "bar.dae"
    path.write_text(text)
    with pytest.raises(InputError, match=r"bar\.dae"):
        read_collada(path)


def test_a_mesh_is_found_beside_and_above_a_urdf_and_in_packages(tmp_path):
    urdf = tmp_path / "toy_description/urdf/toy.urdf"
    urdf.parent.mkdir(parents=True)
    far = tmp_path / "far"
    for place in (urdf.parent / "a.dae", tmp_path / "toy_description/meshes/b.dae", far / "c.dae"):
        place.parent.mkdir(exist_ok=True)
        place.write_text(DAE.format(up="Z_UP", x=2))
    search = MeshSearch(urdf, (far,))
    for address in ("a.dae", "package://toy_description/meshes/b.dae", "package://other/c.dae"):
        assert search.points(address) is not None, address
    assert search.missed == {}
    assert search.points("package://other/d.dae") is None
    assert search.points("package://toy_description/meshes/b.fbx") is None
    assert set(search.missed.values()) == {"it is not at hand"}
