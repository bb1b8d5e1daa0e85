"""The picture of picture.py drawn by VTK, off the screen: ambient occlusion and a highlight instead of soft
shadows. The package `vtk` is installed by whoever wants it (analysis/requirements-render.txt).
"""

import math

import numpy as np
from matplotlib.colors import to_rgb

from barrierbench_analysis.figures.surfaces.obstacle_mesh import obstacle_mesh
from barrierbench_analysis.figures.surfaces.rasterizer import Camera, corner_normals
from barrierbench_analysis.io.errors import UserError

from .picture import LIGHT, OBSTACLE_COLOR, OVERSAMPLING, SHOWN, Surfaces

INSTALL = ".venv/bin/python -m pip install --requirement analysis/requirements-render.txt"
LINE_OPACITY = 0.3  # sides of the triangles of bodies
OCCLUSION = 0.25  # radius within which surfaces darken each other, for a metre of reach


def _vtk():
    try:
        import vtkmodules.all as vtk
    except ImportError:
        raise UserError(f"--renderer vtk: the package vtk is not installed: {INSTALL}") from None
    vtk.vtkObject.GlobalWarningDisplayOff()  # that there is no X server
    return vtk


def _data(points: np.ndarray, cells: np.ndarray, **fields: np.ndarray):
    """Triangles or segments on points; normals and colours of the points."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

    vtk, made = _vtk(), _vtk().vtkPolyData()
    at, array = vtk.vtkPoints(), vtk.vtkCellArray()
    at.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    made.SetPoints(at)
    width = cells.shape[1]
    array.SetData(width, numpy_to_vtkIdTypeArray(np.ascontiguousarray(cells, np.int64).ravel(), deep=True))
    (made.SetLines if width == 2 else made.SetPolys)(array)
    for name, values in fields.items():
        getattr(made.GetPointData(), f"Set{name}")(numpy_to_vtk(np.ascontiguousarray(values), deep=True))
    return made


def _actor(data, color: tuple[float, float, float] | None = None):
    vtk = _vtk()
    mapper, actor = vtk.vtkPolyDataMapper(), vtk.vtkActor()
    mapper.SetInputData(data)
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToPhong()
    look.SetAmbient(0.45)
    look.SetDiffuse(0.65)
    look.SetSpecular(0.12)
    look.SetSpecularPower(25)
    if color is not None:
        look.SetColor(*color)
    return actor


def _actors(surfaces: Surfaces, center: np.ndarray, reach: float) -> list:
    x, triangles = surfaces.points, surfaces.triangles
    apart = np.arange(3 * len(triangles)).reshape(-1, 3)  # each triangle has corners of its own
    colors = np.uint8(np.round(255 * surfaces.corner_colors)).reshape(-1, 3)
    normals = corner_normals(x, triangles).reshape(-1, 3)
    found = [_actor(_data(x[triangles].reshape(-1, 3), apart, Normals=normals, Scalars=colors))]
    if surfaces.n_lined:
        sides = np.sort(triangles[: surfaces.n_lined, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        lines = _actor(_data(x, np.unique(sides, axis=0)), (0.0, 0.0, 0.0))
        lines.GetProperty().SetOpacity(LINE_OPACITY)
        lines.GetProperty().SetLineWidth(1.5 * OVERSAMPLING)
        lines.GetMapper().SetResolveCoincidentTopologyToPolygonOffset()
        found.append(lines)
    for obstacle in surfaces.obstacles:
        points, cells = obstacle_mesh(obstacle, center, SHOWN * reach)
        normals = corner_normals(points, cells).reshape(-1, 3)
        apart = np.arange(3 * len(cells)).reshape(-1, 3)
        data = _data(points[cells].reshape(-1, 3), apart, Normals=normals)
        found.append(_actor(data, to_rgb(OBSTACLE_COLOR)))
        found[-1].GetProperty().SetBackfaceCulling(
            bool(obstacle.get("inside")) or obstacle["kind"] == "plane"
        )
    return found


def _aim(view, camera: Camera, width: int, height: int) -> None:
    """Sets VTK's camera to ours, whose pixels are those of the oversampled picture."""
    view.SetPosition(camera.eye)
    view.SetFocalPoint(camera.target)
    view.SetViewUp(camera.up)
    if camera.perspective:
        view.SetViewAngle(2 * math.degrees(math.atan(height / 2 / camera.scale)))
    else:
        view.ParallelProjectionOn()
        view.SetParallelScale(height / 2 / camera.scale)
    view.SetWindowCenter(1 - 2 * camera.center[0] / width, 2 * camera.center[1] / height - 1)


def picture(
    surfaces: Surfaces, camera: Camera, size: tuple[int, int], planar: bool, center: np.ndarray, reach: float
) -> np.ndarray:
    """[height, width, 3] in 0..1. Errors: UserError where VTK is not installed, or has no OpenGL."""
    vtk = _vtk()
    from vtkmodules.util.numpy_support import vtk_to_numpy

    width, height = (OVERSAMPLING * s for s in size)
    renderer, window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
    renderer.SetBackground(1, 1, 1)
    for actor in _actors(surfaces, center, reach):
        renderer.AddActor(actor)
    lamp = vtk.vtkLight()
    lamp.SetLightTypeToSceneLight()
    lamp.SetPosition(*(center + 10 * reach * LIGHT))
    lamp.SetFocalPoint(*center)
    renderer.AddLight(lamp)
    if not planar:
        occlusion = vtk.vtkSSAOPass()
        occlusion.SetRadius(OCCLUSION * reach)
        occlusion.SetBias(0.002 * reach)
        occlusion.SetKernelSize(128)
        occlusion.BlurOn()
        occlusion.SetDelegatePass(vtk.vtkRenderStepsPass())
        renderer.SetPass(occlusion)
    window.SetOffScreenRendering(True)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    _aim(renderer.GetActiveCamera(), camera, width, height)
    renderer.ResetCameraClippingRange()
    window.Render()
    if not window.SupportsOpenGL():
        raise UserError("--renderer vtk: VTK has no OpenGL here; allowed: --renderer own, or EGL or OSMesa")
    grabbed = vtk.vtkWindowToImageFilter()
    grabbed.SetInput(window)
    grabbed.ReadFrontBufferOff()
    grabbed.Update()
    image = vtk_to_numpy(grabbed.GetOutput().GetPointData().GetScalars())
    image = image.reshape(height, width, 3)[::-1] / 255
    return image.reshape(size[1], OVERSAMPLING, size[0], OVERSAMPLING, 3).mean(axis=(1, 3))
