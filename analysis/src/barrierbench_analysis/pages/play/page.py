"""Films to one HTML file that needs no network: markup, style and scripts of this folder, the library that
draws (K3D on three.js, compressed), and the arrays of the films (compressed).

K3D's own snapshot draws one plot and has no colour choice, no captions and no second view in step, so the
page makes two of its plots itself. The page forbids every connection (Content-Security-Policy).
"""

import base64
import importlib.metadata
import importlib.util
import json
import re
import zlib
from pathlib import Path

import numpy as np

from barrierbench_analysis.figures.pictures.coloring import BODY_COLORS
from barrierbench_analysis.figures.pictures.film import Film, shaded_mesh
from barrierbench_analysis.figures.pictures.picture import OBSTACLE_COLOR
from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import points_of_bodies
from barrierbench_analysis.tables.run_rows import case_name, own_name

from .scales import FIELDS, NOT_COMPUTED, longest_arrow, scale

HERE = Path(__file__).resolve().parent
SCRIPTS = ("shapes.js", "view.js", "player.js")
ROD_SHARE = 0.006  # radius of a drawn rod, of the radius of all that is shown
ARROW_SHARE = 0.3  # length of the longest arrow, of that radius
# What K3D would ask for: fonts beside the page (it has each of them inside too), itself from a network.
ELSEWHERE = re.compile(
    r',url\(fonts/[^)]*\) format\("\w+"\)|https://(?:unpkg\.com|cdnjs\.cloudflare\.com)/[\w@./\[\]-]*'
)
LIBRARY_BYTES = 1_200_000  # of the page without films, about


def page_bytes(film_bytes: int) -> int:
    """Most that a page with so many bytes of films takes: base64 makes 4 bytes of 3; compression is not
    counted on.
    """
    return LIBRARY_BYTES + film_bytes * 4 // 3


def _packed(data: bytes) -> str:
    return base64.b64encode(zlib.compress(data, 9)).decode("ascii")


def library() -> tuple[str, str]:
    """JavaScript of K3D, and the licences that go with it. Errors: UserError where it is not installed."""
    spec = importlib.util.find_spec("k3d")
    if spec is None or spec.origin is None:
        raise UserError(
            "the Python package k3d is not installed (analysis/requirements-play.txt): ./bench setup"
        )
    folder = Path(spec.origin).parent / "static"
    own = importlib.metadata.distribution("k3d")
    licences = [input_file.read_text(folder / "standalone.js.LICENSE.txt")]
    licences += [
        input_file.read_text(path.locate()) for path in own.files or [] if path.name == "LICENSE.txt"
    ]
    source = ELSEWHERE.sub("", input_file.read_text(folder / "standalone.js"))
    return source, f"K3D {own.version}\n\n" + "\n".join(licences)


def _film_data(film: Film) -> tuple[dict, bytes]:
    """Counts and words of a film for the page, and its arrays in the order in which the page reads them."""
    source, drawn = shaded_mesh(film.start)
    body = film.start.of_vertices["body"]
    whole = (drawn, film.start.triangles, source, film.start.edges, body)
    parts = [np.ascontiguousarray(array, "<u4").tobytes() for array in whole]
    parts += [
        np.ascontiguousarray(array, "<f4").tobytes()
        for array in (film.positions, film.gap_rel, film.force_N, film.stretch)
    ]
    if film.arrows_N is not None:
        parts.append(np.ascontiguousarray(np.nan_to_num(film.arrows_N), "<f4").tobytes())
    words = {"formulation": case_name(film.labels), "scene": own_name(film.labels) or film.labels["scene"]}
    words |= {"run": Path(film.run).name, "outcome": film.outcome, "steps": film.steps, "times": film.times_s}
    words |= {name: film.scene[name] for name in ("bodies", "obstacles")}
    words |= {"forces": film.arrows_N is not None}
    counted = {"vertices": body, "drawn": source, "triangles": drawn, "edges": film.start.edges}
    return words | {f"n_{name}": len(of) for name, of in counted.items()}, b"".join(parts)


def box(films: list[Film]) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest coordinates (m) of all that the films show: bodies in every frame, and spheres."""
    points = [points_of_bodies(film.scene, film.positions).reshape(-1, 3) for film in films]
    for film in films:
        for o in film.scene["obstacles"]:
            if o["kind"] == "sphere" and not o.get("inside"):
                at = film.positions[:, o["vertex"]] if "vertex" in o else np.array([o["point_m"]], float)
                points += [at - o["radius_m"], at + o["radius_m"]]
    return np.min([p.min(axis=0) for p in points], axis=0), np.max([p.max(axis=0) for p in points], axis=0)


def packed_library() -> str:
    """The library as it stands in a page. Errors: UserError where it is not installed."""
    return _packed(library()[0].encode())


def page(films: list[Film], colour: str, notes: list[str], shared_library: str = "") -> str:
    """The HTML of one film, or of two side by side. notes: sentences that the page shows. shared_library:
    what stands in the place of the library, for a page that has it already.
    """
    packed = [_film_data(film) for film in films]
    low, high = box(films)
    radius = max(float(np.linalg.norm(high - low)) / 2, 1e-6)
    licences = library()[1]
    words = {"colour": colour, "scales": {name: scale(films, name) for name in FIELDS}}
    words |= {"body_colours": BODY_COLORS, "obstacle_colour": OBSTACLE_COLOR, "not_computed": NOT_COMPUTED}
    words |= {"low": low.tolist(), "high": high.tolist(), "middle": ((low + high) / 2).tolist()}
    words |= {"radius": radius, "rod_radius": ROD_SHARE * radius, "notes": notes}
    words |= {"longest_arrow_N": longest_arrow(films), "longest_arrow_m": ARROW_SHARE * radius}
    words |= {"planar": all(film.scene["planar"] for film in films), "films": [about for about, _ in packed]}
    data = "\n".join(
        f'<script type="application/octet-stream" id="film-{k}">{_packed(arrays)}</script>'
        for k, (_, arrays) in enumerate(packed)
    )
    text = input_file.read_text(HERE / "page.html")
    values = {"style": input_file.read_text(HERE / "page.css"), "films": data}
    values |= {"licences": licences.replace("&", "&amp;").replace("<", "&lt;")}
    values |= {"words": json.dumps(words, allow_nan=False).replace("<", "\\u003c")}  # it stands in a script
    values |= {"library": shared_library or packed_library()}
    values |= {"scripts": "\n".join(input_file.read_text(HERE / name) for name in SCRIPTS)}
    return re.sub(r"\{\{(\w+)\}\}", lambda slot: values[slot[1]], text)
