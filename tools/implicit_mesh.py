"""Fine meshes of implicit surfaces, for a renderer that has none; made from the formula alone.

Marching cubes (Lorensen, Cline 1987; the tables of Lewiner et al. 2003) over cells of the box that
clips the surface say which edges of the grid the surface crosses; each vertex is then moved along
its edge to the zero of the field by bisection, to the last bit. How far mesh and surface are apart
is measured in both directions, see [`distances`].
"""

import ast

import numpy as np
from scipy.spatial import cKDTree
from skimage.measure import marching_cubes

from scene_file import SceneError

CELLS = 256
GOLDEN = (1 + 5**0.5) / 2
# Fields and boxes by name, as scenes/README.md lists them.
NAMED = {
    "heart": ("(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3", {}, 1.5),
    "mitchell": ("4*(x^4 + (y^2 + z^2)^2) + 17*x^2*(y^2 + z^2) - 20*(x^2 + y^2 + z^2) + 17", {}, 3),
    "torus": ("(x^2 + y^2 + z^2 + major^2 - minor^2)^2 - 4*major^2*(x^2 + y^2)", {"major": 1, "minor": 0.25}, 2),
    "goursat": ("a*(x^4 + y^4 + z^4) - b*(x^2 + y^2 + z^2) + c", {"a": 5, "b": 25, "c": 59}, 3),
    "cassini": ("((x - a)^2 + y^2 + z^2)*((x + a)^2 + y^2 + z^2) - b^4", {"a": 1, "b": 1}, 2),
    "chmutov": (
        "32*(x^6 + y^6 + z^6) - 48*(x^4 + y^4 + z^4) + 18*(x^2 + y^2 + z^2) - 3 + c",
        {"c": 1},
        1.5,
    ),
    "decocube": (
        "((x^2 + y^2 - a)^2 + (z^2 - 1)^2)*((y^2 + z^2 - a)^2 + (x^2 - 1)^2)*((z^2 + x^2 - a)^2 + (y^2 - 1)^2) - b",
        {"a": 0.640625, "b": 0.01953125},
        2,
    ),
}
FUNCTIONS = {
    name: getattr(np, name) for name in ("sqrt", "abs", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh")
} | {
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "min": lambda *values: np.minimum.reduce(np.broadcast_arrays(*values)),
    "max": lambda *values: np.maximum.reduce(np.broadcast_arrays(*values)),
}
ALLOWED = (ast.Expression, ast.BinOp, ast.UnaryOp, ast.Call, ast.Name, ast.Constant, ast.Load, ast.Add, ast.Sub)
ALLOWED += (ast.Mult, ast.Div, ast.Pow, ast.USub, ast.UAdd)
# Step of central differences: the third root of the rounding unit, where their error is least.
STEP = np.finfo(float).eps ** (1 / 3)


class Field:
    """A field f(x, y, z) with the box that clips it."""

    def __init__(self, form):
        name = form["implicit"]
        expression, known, half = NAMED.get(name, (name, {}, None))
        if half is None and name.isidentifier():
            raise SceneError(f"the surface {name!r} has singular lines or points that a mesh does not follow")
        if form.get("closed"):
            raise SceneError("a mesh has no faces where its box cuts it: `closed = true` has no counterpart")
        box = form.get("inside", [[-half] * 3, [half] * 3] if half else None)
        self.low, self.high = np.array(box, float)
        self.values = {"pi": np.pi, "power": power} | FUNCTIONS
        for key, value in (known | form.get("parameters", {})).items():
            self.values[key] = evaluate(compiled(str(value)), self.values)
        self.code = compiled(expression)

    def __call__(self, points):
        """f at points (…×3)."""
        x, y, z = np.moveaxis(np.asarray(points, float), -1, 0)
        return np.broadcast_to(evaluate(self.code, self.values | {"x": x, "y": y, "z": z}), x.shape)

    def gradient(self, points):
        """Its gradient by central differences."""
        step = STEP * np.abs(self.high - self.low).max()
        parts = [(self(points + h) - self(points - h)) / (2 * step) for h in step * np.eye(3)]
        return np.stack(parts, axis=-1)


class Powers(ast.NodeTransformer):
    """Writes whole powers as calls of [`power`], which is many times faster than NumPy's own."""

    def visit_BinOp(self, node):
        """A sum, product or power."""
        self.generic_visit(node)
        exponent = node.right
        if not (
            isinstance(node.op, ast.Pow) and isinstance(exponent, ast.Constant) and isinstance(exponent.value, int)
        ):
            return node
        return ast.copy_location(ast.Call(ast.Name("power", ast.Load()), [node.left, exponent], []), node)


def power(base, exponent):
    """base to a whole power, by squaring."""
    result = 1.0
    while exponent:
        if exponent % 2:
            result = result * base
        base, exponent = base * base, exponent // 2
    return result


def compiled(text):
    """Code of an expression of scenes/README.md, which binds as Python does but for the sign of powers."""
    tree = ast.parse(text.replace("^", "**").strip(), mode="eval")
    for node in ast.walk(tree):
        if not isinstance(node, ALLOWED):
            raise SceneError(f"cannot read the expression {text!r}")
    return compile(ast.fix_missing_locations(Powers().visit(tree)), "<field>", "eval")


def evaluate(code, names):
    """The value of an expression."""
    return eval(code, {"__builtins__": {}}, names)  # names and node types are checked by `compiled`


def mesh(field, cells=CELLS):
    """Vertices (n×3), unit normals (n×3, to where f > 0) and triangles (m×3) in object coordinates."""
    extent = field.high - field.low
    count = np.maximum(np.round(cells * extent / extent.max()).astype(int), 8) + 1
    axes = [np.linspace(low, high, n) for low, high, n in zip(field.low, field.high, count, strict=True)]
    samples = field(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1))
    if samples.min() >= 0 or samples.max() <= 0:
        raise SceneError("the surface crosses no cell of its box")
    spots, triangles, _, _ = marching_cubes(samples, 0.0, gradient_direction="ascent")
    vertices = on_surface(field, axes, spots)
    normals = field.gradient(vertices)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return vertices, normals, outward(vertices, normals, without_slivers(vertices, triangles))


def on_surface(field, axes, spots):
    """Zeros of the field on the edges of the grid where `spots` (in cells) lie."""
    spots = spots.astype(float)
    along = np.abs(spots - np.round(spots)).argmax(axis=1)
    row = np.arange(len(spots))
    low, high = np.round(spots), np.round(spots)
    low[row, along], high[row, along] = np.floor(spots[row, along]), np.ceil(spots[row, along])
    origin, step = np.array([axis[0] for axis in axes]), np.array([axis[1] - axis[0] for axis in axes])
    low, high = origin + step * low, origin + step * high
    below = field(low) < 0
    for _ in range(60):
        centre = (low + high) / 2
        same = (field(centre) < 0) == below
        low[same], high[~same] = centre[same], centre[~same]
    return (low + high) / 2


def without_slivers(vertices, triangles):
    """Triangles that have an area."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return triangles[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0]


def outward(vertices, normals, triangles):
    """Triangles that turn counterclockwise seen from where f > 0."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals[triangles].sum(axis=1)) < 0
    triangles = triangles.copy()
    triangles[inward] = triangles[inward][:, ::-1]
    return triangles


def distances(field, vertices, normals, triangles, seed=0):
    """How far mesh and surface are apart, in object coordinates, and their normals, in radians.

    `outside`, `mean`: largest and mean distance to the surface over edge midpoints and centroids of all triangles,
    where it is largest on a smooth surface; `missed`: largest distance to the mesh over random points of the
    surface; `normal`: the 99.9 % quantile of the angle between the mesh's interpolated normal and
    the surface's.
    """
    random = np.random.default_rng(seed)
    corners = vertices[triangles]
    weights = [(1 / 3, 1 / 3, 1 / 3), (0.5, 0.5, 0), (0, 0.5, 0.5), (0.5, 0, 0.5)]
    points = np.concatenate([np.einsum("i,nij->nj", np.array(w), corners) for w in weights])
    smooth = np.concatenate([np.einsum("i,nij->nj", np.array(w), normals[triangles]) for w in weights])
    foot = nearest(field, points, 2)
    true = field.gradient(foot)
    angle = np.linalg.norm(unit(smooth) - unit(true), axis=1)
    surface = nearest(field, random.uniform(field.low, field.high, (50_000, 3)), 20)
    kept = (np.abs(field(surface)) < 1e-9 * np.linalg.norm(field.gradient(surface), axis=1)) & np.all(
        (surface > field.low) & (surface < field.high), axis=1
    )
    tree = cKDTree(vertices)
    _, index = tree.query(surface[kept])
    gap = np.abs(np.einsum("ij,ij->i", surface[kept] - vertices[index], normals[index]))
    return {
        "outside": float(np.nanmax(np.linalg.norm(points - foot, axis=1))),
        "mean": float(np.nanmean(np.linalg.norm(points - foot, axis=1))),
        "missed": float(gap.max()),
        "normal": float(np.nanquantile(angle, 0.999)),
    }


def unit(vectors):
    """Vectors of length one; NaN where there is none."""
    with np.errstate(invalid="ignore"):
        return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def nearest(field, points, steps):
    """Points of the surface near the given ones: Newton's method along the gradient."""
    points = points.copy()
    for _ in range(steps):
        slope = field.gradient(points)
        square = np.einsum("ij,ij->i", slope, slope)
        points -= slope * (field(points) / np.maximum(square, 1e-300))[:, None]
    return points
