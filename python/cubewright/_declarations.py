"""Holds the declarations of the C library: structs, enums, constants and functions.

Made by generate_declarations.py from include/cubewright; do not edit.
"""

# ruff: noqa
from __future__ import annotations

import enum
from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    c_bool,
    c_char,
    c_char_p,
    c_double,
    c_float,
    c_int,
    c_int8,
    c_int16,
    c_int32,
    c_int64,
    c_size_t,
    c_ssize_t,
    c_uint,
    c_uint8,
    c_uint16,
    c_uint32,
    c_uint64,
    c_void_p,
)
from typing import Any

CW_CAMERA_TEXT = 1024
CW_LABELS_MAX = 255
CW_ANGLE_BINS = 18
CW_ASPECT_BINS = 9
CW_LENGTH_BINS = 20
CW_BUDGET_LEVELS = 4
CW_MAX_VERDICTS = 32
CW_LABEL_NUMBER = 24
CW_TEAM_MAX = 4096
CW_TRANSFER_POINTS = 64
CW_MAX_MATERIALS = 8
CW_TRANSFER_TEXT = 20480
CW_MAX_LIGHTS = 4
CW_MAX_CLIPS = 12
CW_MAX_SLICES = 4
CW_APPEARANCE_MAX_SIZE = 4096
CW_APPEARANCE_MAX_VIEWS = 64
CW_CAP_ANGLE_DEG = 160.0
CW_CORNER_NORMALS = 'corner_normals'
CW_ENGRAVE_CHARACTERS = 400
CW_EXTRACT_BRICK = 16
CW_EXTRACT_MAX_SNAP = 0.5
CW_FACE_COLORS = 'face_colors'
CW_FEM_MAX_ASPECT = 10.0
CW_FEM_MIN_ANGLE_DEG = 10.0
CW_HANDLE_FRACTION = 0.03
CW_MAX_CUT_PLANES = 256
CW_MIN_TIP_DEG = 5.0
CW_NEEDLE_RATIO = 20.0
CW_OCCLUSION_DIVISOR = 4
CW_PRINT_MAX_MM = 400.0
CW_PRINT_MIN_MM = 5.0
CW_SECTION_ATTRIBUTE = 'section'
CW_SIMPLIFIER_SLAB = 524288
CW_TEXTURE_COORDINATES = 'texture_coordinates'
CW_VERSION = '0.2.0'


class cw_status(enum.IntEnum):
    CW_OK = 0
    CW_ERR_CHECK = 1
    CW_ERR_ARGUMENT = 2
    CW_ERR_IO = 3
    CW_ERR_FORMAT = 4
    CW_ERR_BACKEND = 5
    CW_ERR_UNSAFE = 6
    CW_ERR_UNSUPPORTED = 7
    CW_ERR_OUTPUT = 8
    CW_ERR_BATCH = 9
    CW_ERR_LIMIT = 10
    CW_ERR_NO_MEMORY = 11
    CW_ERR_EMPTY = 12
    CW_ERR_CANCELLED = 13
    CW_STATUS_COUNT = 14


class cw_type(enum.IntEnum):
    CW_U8 = 0
    CW_I8 = 1
    CW_U16 = 2
    CW_I16 = 3
    CW_U32 = 4
    CW_I32 = 5
    CW_F32 = 6
    CW_F64 = 7
    CW_TYPE_COUNT = 8


class cw_known(enum.IntEnum):
    CW_KNOWN_UNIT = 1
    CW_KNOWN_FRAME = 2
    CW_KNOWN_LEVEL_SET = 4
    CW_KNOWN_LABELS = 8
    CW_KNOWN_HOUNSFIELD = 16


class cw_shape(enum.IntEnum):
    CW_TETRAHEDRON = 0
    CW_PYRAMID = 1
    CW_WEDGE = 2
    CW_HEXAHEDRON = 3
    CW_SHAPE_COUNT = 4


class cw_on(enum.IntEnum):
    CW_ON_VERTICES = 0
    CW_ON_CORNERS = 1
    CW_ON_TRIANGLES = 2
    CW_ON_PARTS = 3
    CW_ON_COUNT = 4


class cw_interpolation(enum.IntEnum):
    CW_INTERPOLATE_LINEAR = 0
    CW_INTERPOLATE_DIRECTION = 1
    CW_INTERPOLATE_COLOR = 2
    CW_INTERPOLATE_NEAREST = 3
    CW_INTERPOLATE_COUNT = 4


class cw_map(enum.IntEnum):
    CW_MAP_NORMALS = 0
    CW_MAP_OCCLUSION = 1
    CW_MAP_CURVATURE = 2
    CW_MAP_THICKNESS = 3
    CW_MAP_COLORS = 4
    CW_MAP_COUNT = 5


class cw_picture_use(enum.IntEnum):
    CW_PICTURE_COLOR = 0
    CW_PICTURE_NORMAL = 1
    CW_PICTURE_METALLIC_ROUGHNESS = 2
    CW_PICTURE_OCCLUSION = 3
    CW_PICTURE_EMISSIVE = 4
    CW_PICTURE_USES = 5


class cw_boolean_op(enum.IntEnum):
    CW_BOOLEAN_UNION = 0
    CW_BOOLEAN_DIFFERENCE = 1
    CW_BOOLEAN_INTERSECTION = 2
    CW_BOOLEAN_XOR = 3
    CW_BOOLEAN_SPLIT = 4
    CW_BOOLEAN_COUNT = 5


class cw_boolean_input(enum.IntEnum):
    CW_BOOLEAN_EMPTY = 1
    CW_BOOLEAN_TURNED = 2
    CW_BOOLEAN_NEGATIVE = 4


class cw_weld(enum.IntEnum):
    CW_WELD_NONE = 0
    CW_WELD_WORLD = 1
    CW_WELD_LOCAL = 2


class cw_defect(enum.IntEnum):
    CW_DEFECT_OPEN = 1
    CW_DEFECT_NONMANIFOLD = 2
    CW_DEFECT_MISORIENTED = 4
    CW_DEFECT_DUPLICATE = 8
    CW_DEFECT_DEGENERATE = 16
    CW_DEFECT_SLIVER = 32
    CW_DEFECT_INSIDE_OUT = 64
    CW_DEFECT_INTERSECTING = 128


class cw_profile(enum.IntEnum):
    CW_PROFILE_BASIC = 0
    CW_PROFILE_PRINT = 1
    CW_PROFILE_WEB = 2
    CW_PROFILE_FEM = 3
    CW_PROFILE_GAME = 4
    CW_PROFILE_MOBILE = 5


class cw_grade(enum.IntEnum):
    CW_GRADE_FAIL = 0
    CW_GRADE_UNKNOWN = 1
    CW_GRADE_WARN = 2
    CW_GRADE_OK = 3
    CW_GRADE_NOTE = 4


class cw_colormap(enum.IntEnum):
    CW_COLORMAP_VIRIDIS = 0
    CW_COLORMAP_INFERNO = 1
    CW_COLORMAP_COOL_WARM = 2
    CW_COLORMAP_GRAY = 3
    CW_COLORMAP_COUNT = 4


class cw_field(enum.IntEnum):
    CW_FIELD_SPHERE = 0
    CW_FIELD_TORUS = 1
    CW_FIELD_PLANE = 2
    CW_FIELD_GYROID = 3
    CW_FIELD_MARSCHNER_LOBB = 4
    CW_FIELD_CT_HEAD = 5
    CW_FIELD_COUNT = 6


class cw_label_field(enum.IntEnum):
    CW_LABEL_CELLS = 0
    CW_LABEL_SPHERES = 1


class cw_kernel(enum.IntEnum):
    CW_KERNEL_LINEAR = 0
    CW_KERNEL_CUBIC = 1
    CW_KERNEL_LANCZOS = 2
    CW_KERNEL_COUNT = 3


class cw_gaps(enum.IntEnum):
    CW_GAPS_STOP = 0
    CW_GAPS_INTERPOLATE = 1
    CW_GAPS_ALLOW = 2


class cw_tilt(enum.IntEnum):
    CW_TILT_CORRECT = 0
    CW_TILT_KEEP = 1


class cw_unit(enum.IntEnum):
    CW_UNIT_MM = 0
    CW_UNIT_UM = 1
    CW_UNIT_CM = 2
    CW_UNIT_M = 3
    CW_UNIT_IN = 4
    CW_UNIT_FT = 5
    CW_UNIT_COUNT = 6


class cw_claim_rule(enum.IntEnum):
    CW_CLAIM_AGREE = 0
    CW_CLAIM_FILL = 1
    CW_CLAIM_OVERRIDE = 2


class cw_nodata(enum.IntEnum):
    CW_NODATA_FILE = 0
    CW_NODATA_NONE = 1
    CW_NODATA_VALUE = 2


class cw_compression(enum.IntEnum):
    CW_COMPRESS_NONE = 0
    CW_COMPRESS_QUANTIZE = 1
    CW_COMPRESS_DRACO = 2
    CW_COMPRESS_MESHOPT = 3


class cw_keeps(enum.IntEnum):
    CW_KEEPS_SHARING = 1
    CW_KEEPS_PLACES = 2
    CW_KEEPS_NORMALS = 4
    CW_KEEPS_COLORS = 8
    CW_KEEPS_SCALARS = 16
    CW_KEEPS_LABELS = 32
    CW_KEEPS_AFFINE = 64
    CW_KEEPS_PARTS = 128
    CW_KEEPS_ATTRIBUTES = 256
    CW_KEEPS_FACE_COLORS = 512
    CW_KEEPS_OPACITY = 1024
    CW_KEEPS_TEXTURE = 2048
    CW_KEEPS_PICTURES = 4096
    CW_KEEPS_MATERIALS = 8192
    CW_KEEPS_CREASES = 16384
    CW_KEEPS_ALL = 32767


class cw_background_rule(enum.IntEnum):
    CW_BACKGROUND_VALUE = 0
    CW_BACKGROUND_FIELD = 1
    CW_BACKGROUND_REST = 2
    CW_BACKGROUND_RULE_COUNT = 3


class cw_label_kernel(enum.IntEnum):
    CW_LABEL_KERNEL_MAJORITY = 0
    CW_LABEL_KERNEL_NEAREST = 1
    CW_LABEL_KERNEL_COUNT = 2


class cw_infill_kind(enum.IntEnum):
    CW_INFILL_GYROID = 0
    CW_INFILL_SCHWARZ_P = 1
    CW_INFILL_DIAMOND = 2
    CW_INFILL_COUNT = 3


class cw_mode(enum.IntEnum):
    CW_MODE_MESH = 0
    CW_MODE_COMPOSITE = 1
    CW_MODE_MIP = 2
    CW_MODE_MINIP = 3
    CW_MODE_AVERAGE = 4
    CW_MODE_LOCAL_MIP = 5
    CW_MODE_PROJECTION = 6
    CW_MODE_SPLAT = 7
    CW_MODE_SPLAT_TREE = 8
    CW_MODE_TEXTURE = 9
    CW_MODE_SHADED_TEXTURE = 10
    CW_MODE_SLICES = 11
    CW_MODE_VBUFFER = 12
    CW_MODE_REFERENCE = 13
    CW_MODE_COUNT = 14


class cw_backend(enum.IntEnum):
    CW_BACKEND_AUTO = 0
    CW_BACKEND_EGL = 1
    CW_BACKEND_CPU = 2
    CW_BACKEND_COUNT = 3


class cw_cue_form(enum.IntEnum):
    CW_CUE_LINEAR = 0
    CW_CUE_EXPONENTIAL = 1
    CW_CUE_COUNT = 2


class cw_tint(enum.IntEnum):
    CW_TINT_COLORS = 0
    CW_TINT_SCALARS = 1
    CW_TINT_QUALITY = 2
    CW_TINT_COUNT = 3


class cw_target(enum.IntEnum):
    CW_TARGET_32F = 0
    CW_TARGET_16 = 1
    CW_TARGET_16F = 2
    CW_TARGET_8 = 3
    CW_TARGET_COUNT = 4


class cw_direction_filter(enum.IntEnum):
    CW_DIRECTIONS_LINEAR = 0
    CW_DIRECTIONS_NEAREST = 1
    CW_DIRECTIONS_COUNT = 2


class cw_splat_kernel(enum.IntEnum):
    CW_SPLAT_GAUSSIAN = 0
    CW_SPLAT_POLYGON = 1
    CW_SPLAT_TENT = 2
    CW_SPLAT_B_SPLINE = 3
    CW_SPLAT_COUNT = 4


class cw_shadow(enum.IntEnum):
    CW_SHADOW_NONE = 0
    CW_SHADOW_LIGHT = 1
    CW_SHADOW_AMBIENT = 2
    CW_SHADOW_COUNT = 3


class cw_pick_kind(enum.IntEnum):
    CW_PICK_NOTHING = 0
    CW_PICK_VOLUME = 1
    CW_PICK_SLICE = 2
    CW_PICK_MESH = 3


class cw_smooth_method(enum.IntEnum):
    CW_SMOOTH_TAUBIN = 0
    CW_SMOOTH_HC = 1
    CW_SMOOTH_FAIR = 2
    CW_SMOOTH_METHOD_COUNT = 3


class cw_stage(enum.IntEnum):
    CW_STAGE_VIEWS = 0
    CW_STAGE_EXTRACT = 1
    CW_STAGE_MIN_VOLUME = 2
    CW_STAGE_LARGEST = 3
    CW_STAGE_FILL_VOIDS = 4
    CW_STAGE_SMOOTH = 5
    CW_STAGE_CUT = 6
    CW_STAGE_SIMPLIFY = 7
    CW_STAGE_CULL = 8
    CW_STAGE_LOD = 9
    CW_STAGE_NORMALS = 10
    CW_STAGE_COLOR = 11
    CW_STAGE_CHECK = 12
    CW_STAGE_HANDLES = 13
    CW_STAGE_ATLAS = 14
    CW_STAGE_MAPS = 15
    CW_STAGE_CREASES = 16
    CW_STAGE_ENGRAVE = 17
    CW_STAGE_COUNT = 18


class cw_surface_source(enum.IntEnum):
    CW_SOURCE_MEMORY = 0
    CW_SOURCE_SLICES = 1
    CW_SOURCE_PARTS = 2
    CW_SOURCE_LABELS = 3
    CW_SOURCE_MESH = 4
    CW_SOURCE_COUNT = 5


class cw_slice_filter_kind(enum.IntEnum):
    CW_SLICE_GAUSS = 0
    CW_SLICE_MEDIAN = 1


class cw_error(Structure):
    status: int
    message: Any


cw_error._fields_ = [
    ("status", c_int),
    ("message", c_char * 512),
]


class cw_progress(Structure):
    report: Any
    user: Any


cw_progress._fields_ = [
    ("report", CFUNCTYPE(c_bool, c_void_p, c_char_p, c_double)),
    ("user", c_void_p),
]


class cw_overflow_desc(Structure):
    version: int
    path: bytes | None
    report: Any
    user: Any


cw_overflow_desc._fields_ = [
    ("version", c_uint32),
    ("path", c_char_p),
    ("report", CFUNCTYPE(None, c_void_p, c_size_t)),
    ("user", c_void_p),
]


class cw_allocator(Structure):
    allocate: Any
    release: Any
    user: Any


cw_allocator._fields_ = [
    ("allocate", CFUNCTYPE(c_void_p, c_void_p, c_size_t)),
    ("release", CFUNCTYPE(None, c_void_p, c_void_p, c_size_t)),
    ("user", c_void_p),
]


class cw_feature(Structure):
    name: bytes | None
    about: bytes | None
    available: bool
    reason: bytes | None


cw_feature._fields_ = [
    ("name", c_char_p),
    ("about", c_char_p),
    ("available", c_bool),
    ("reason", c_char_p),
]


class cw_camera(Structure):
    eye: Any
    target: Any
    up: Any
    fov_deg: float
    height_mm: float


cw_camera._fields_ = [
    ("eye", c_double * 3),
    ("target", c_double * 3),
    ("up", c_double * 3),
    ("fov_deg", c_double),
    ("height_mm", c_double),
]


class cw_fit_desc(Structure):
    version: int
    view: bytes | None
    min: Any
    max: Any
    aspect: float
    fov_deg: float
    margin: float
    azimuth_deg: float
    elevation_deg: float


cw_fit_desc._fields_ = [
    ("version", c_uint32),
    ("view", c_char_p),
    ("min", c_double * 3),
    ("max", c_double * 3),
    ("aspect", c_double),
    ("fov_deg", c_double),
    ("margin", c_double),
    ("azimuth_deg", c_double),
    ("elevation_deg", c_double),
]


class cw_cells(Structure):
    points: Any
    count: int
    shapes: Any
    corners: Any


cw_cells._fields_ = [
    ("points", POINTER(c_double)),
    ("count", c_size_t),
    ("shapes", POINTER(c_uint8)),
    ("corners", POINTER(c_uint32)),
]


class cw_tile(Structure):
    at: Any
    size: Any
    value: float


cw_tile._fields_ = [
    ("at", c_uint32 * 3),
    ("size", c_uint32 * 3),
    ("value", c_double),
]


class cw_sparse(Structure):
    leaf_count: int
    leaves: Any
    tile_count: int
    tiles: Any
    background: float


cw_sparse._fields_ = [
    ("leaf_count", c_size_t),
    ("leaves", POINTER(c_uint32 * 3)),
    ("tile_count", c_size_t),
    ("tiles", POINTER(cw_tile)),
    ("background", c_double),
]


class cw_volume(Structure):
    data: Any
    type: int
    dim: Any
    stride: Any
    components: int
    component_stride: int
    steps: int
    step_stride: int
    step_seconds: float
    affine: Any
    coordinates: Any
    cells: Any
    sparse: Any
    slope: float
    intercept: float
    has_nodata: bool
    nodata: float
    known: int
    said_unit_mm: float
    said_ras: bool
    owned: Any
    owned_grid: Any


cw_volume._fields_ = [
    ("data", c_void_p),
    ("type", c_int),
    ("dim", c_size_t * 3),
    ("stride", c_ssize_t * 3),
    ("components", c_size_t),
    ("component_stride", c_ssize_t),
    ("steps", c_size_t),
    ("step_stride", c_ssize_t),
    ("step_seconds", c_double),
    ("affine", (c_double * 4) * 3),
    ("coordinates", POINTER(c_double) * 3),
    ("cells", POINTER(cw_cells)),
    ("sparse", POINTER(cw_sparse)),
    ("slope", c_double),
    ("intercept", c_double),
    ("has_nodata", c_bool),
    ("nodata", c_double),
    ("known", c_uint),
    ("said_unit_mm", c_double),
    ("said_ras", c_bool),
    ("owned", c_void_p),
    ("owned_grid", c_void_p),
]


class cw_box(Structure):
    first: Any
    count: Any


cw_box._fields_ = [
    ("first", c_size_t * 3),
    ("count", c_size_t * 3),
]


class cw_labels(Structure):
    found: bool
    more: bool
    scattered: bool
    count: int
    value: Any


cw_labels._fields_ = [
    ("found", c_bool),
    ("more", c_bool),
    ("scattered", c_bool),
    ("count", c_size_t),
    ("value", c_double * 255),
]


class cw_statistics(Structure):
    min: float
    max: float
    finite: int
    not_finite: int
    nodata: int
    quantum: float
    bin_count: int
    bin_width: float
    bins: Any


cw_statistics._fields_ = [
    ("min", c_double),
    ("max", c_double),
    ("finite", c_size_t),
    ("not_finite", c_size_t),
    ("nodata", c_size_t),
    ("quantum", c_double),
    ("bin_count", c_size_t),
    ("bin_width", c_double),
    ("bins", POINTER(c_uint64)),
]


class cw_attribute(Structure):
    name: Any
    on: int
    type: int
    components: int
    interpolation: int
    data: Any


cw_attribute._fields_ = [
    ("name", c_char * 32),
    ("on", c_int),
    ("type", c_int),
    ("components", c_uint32),
    ("interpolation", c_int),
    ("data", c_void_p),
]


class cw_mesh(Structure):
    version: int
    origin: Any
    vertex_count: int
    triangle_count: int
    positions: Any
    normals: Any
    triangles: Any
    scalars: Any
    colors: Any
    labels: Any
    affine: Any
    attributes: Any
    attribute_count: int


cw_mesh._fields_ = [
    ("version", c_uint32),
    ("origin", c_double * 3),
    ("vertex_count", c_size_t),
    ("triangle_count", c_size_t),
    ("positions", POINTER(c_float)),
    ("normals", POINTER(c_float)),
    ("triangles", POINTER(c_uint32)),
    ("scalars", POINTER(c_float)),
    ("colors", POINTER(c_uint8)),
    ("labels", POINTER(c_uint32)),
    ("affine", (c_double * 4) * 3),
    ("attributes", POINTER(cw_attribute)),
    ("attribute_count", c_size_t),
]


class cw_drop_counts(Structure):
    dropped: int
    kept: int
    triangles: int
    dropped_mm3: float
    largest_mm3: float
    least_kept_mm3: float
    cavities: int


cw_drop_counts._fields_ = [
    ("dropped", c_size_t),
    ("kept", c_size_t),
    ("triangles", c_size_t),
    ("dropped_mm3", c_double),
    ("largest_mm3", c_double),
    ("least_kept_mm3", c_double),
    ("cavities", c_size_t),
]


class cw_slab(Structure):
    mesh: Any
    seam: Any
    along: Any
    low: float
    high: float
    triangles: int
    last: bool


cw_slab._fields_ = [
    ("mesh", POINTER(cw_mesh)),
    ("seam", POINTER(c_uint8)),
    ("along", c_double * 3),
    ("low", c_double),
    ("high", c_double),
    ("triangles", c_size_t),
    ("last", c_bool),
]


class cw_slab_sink(Structure):
    take: Any
    user: Any


cw_slab_sink._fields_ = [
    ("take", CFUNCTYPE(c_int, c_void_p, POINTER(cw_slab), POINTER(cw_error))),
    ("user", c_void_p),
]


class cw_picture(Structure):
    width: int
    height: int
    pixels: Any


cw_picture._fields_ = [
    ("width", c_size_t),
    ("height", c_size_t),
    ("pixels", POINTER(c_float)),
]


class cw_image(Structure):
    width: int
    height: int
    pixels: Any
    deep: Any


cw_image._fields_ = [
    ("width", c_size_t),
    ("height", c_size_t),
    ("pixels", POINTER(c_uint8)),
    ("deep", POINTER(c_uint16)),
]


class cw_comparison(Structure):
    pixels: int
    rmse: float
    max: float
    bias: float
    delta_e_mean: float
    delta_e_p99: float
    delta_e_max: float
    ssim: float


cw_comparison._fields_ = [
    ("pixels", c_size_t),
    ("rmse", c_double),
    ("max", c_double),
    ("bias", c_double),
    ("delta_e_mean", c_double),
    ("delta_e_p99", c_double),
    ("delta_e_max", c_double),
    ("ssim", c_double),
]


class cw_surface_look(Structure):
    mesh: Any
    normal_map: Any
    color_map: Any
    occlusion_map: Any


cw_surface_look._fields_ = [
    ("mesh", POINTER(cw_mesh)),
    ("normal_map", POINTER(cw_image)),
    ("color_map", POINTER(cw_image)),
    ("occlusion_map", POINTER(cw_image)),
]


class cw_appearance_desc(Structure):
    version: int
    views: int
    size: int
    threads: int
    progress: Any


cw_appearance_desc._fields_ = [
    ("version", c_uint32),
    ("views", c_uint32),
    ("size", c_uint32),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_look_difference(Structure):
    pixels: int
    shown_by_one: int
    rmse: float
    psnr_db: float
    delta_e: float
    rmse_both: float
    psnr_both_db: float
    delta_e_both: float


cw_look_difference._fields_ = [
    ("pixels", c_size_t),
    ("shown_by_one", c_size_t),
    ("rmse", c_double),
    ("psnr_db", c_double),
    ("delta_e", c_double),
    ("rmse_both", c_double),
    ("psnr_both_db", c_double),
    ("delta_e_both", c_double),
]


class cw_appearance_view(Structure):
    camera: Any
    azimuth_deg: float
    elevation_deg: float


cw_appearance_view._fields_ = [
    ("camera", cw_camera),
    ("azimuth_deg", c_double),
    ("elevation_deg", c_double),
]


class cw_appearance(Structure):
    views: int
    size: int
    worst: int
    all: Any
    view: Any
    place: Any


cw_appearance._fields_ = [
    ("views", c_uint32),
    ("size", c_uint32),
    ("worst", c_uint32),
    ("all", cw_look_difference),
    ("view", cw_look_difference * 64),
    ("place", cw_appearance_view * 64),
]


class cw_atlas_desc(Structure):
    version: int
    size: int
    margin: int
    texels_per_mm: float
    max_stretch: float
    threads: int
    progress: Any


cw_atlas_desc._fields_ = [
    ("version", c_uint32),
    ("size", c_uint32),
    ("margin", c_uint32),
    ("texels_per_mm", c_double),
    ("max_stretch", c_double),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_atlas_facts(Structure):
    size: int
    margin: int
    charts: int
    seams: int
    vertices: int
    texels_per_mm: float
    stretch: float
    coverage: float
    flipped: int


cw_atlas_facts._fields_ = [
    ("size", c_uint32),
    ("margin", c_uint32),
    ("charts", c_size_t),
    ("seams", c_size_t),
    ("vertices", c_size_t),
    ("texels_per_mm", c_double),
    ("stretch", c_double),
    ("coverage", c_double),
    ("flipped", c_size_t),
]


class cw_texture_distance(Structure):
    samples: int
    max_mm: float
    mean_mm: float
    side_mm: float


cw_texture_distance._fields_ = [
    ("samples", c_size_t),
    ("max_mm", c_double),
    ("mean_mm", c_double),
    ("side_mm", c_double),
]


class cw_bake_desc(Structure):
    version: int
    size: int
    margin: int
    reach_mm: float
    threads: int
    progress: Any
    maps: int
    occlusion_mm: float
    thickness_mm: float
    curvature_max: float
    deep: bool


cw_bake_desc._fields_ = [
    ("version", c_uint32),
    ("size", c_uint32),
    ("margin", c_uint32),
    ("reach_mm", c_double),
    ("threads", c_int),
    ("progress", cw_progress),
    ("maps", c_uint),
    ("occlusion_mm", c_double),
    ("thickness_mm", c_double),
    ("curvature_max", c_double),
    ("deep", c_bool),
]


class cw_bake_facts(Structure):
    texels: int
    missed: int
    max_mm: float
    mean_mm: float
    mean_deg: float
    reach_mm: float
    occlusion_mm: float
    thickness_mm: float
    curvature_max: float


cw_bake_facts._fields_ = [
    ("texels", c_size_t),
    ("missed", c_size_t),
    ("max_mm", c_double),
    ("mean_mm", c_double),
    ("mean_deg", c_double),
    ("reach_mm", c_double),
    ("occlusion_mm", c_double),
    ("thickness_mm", c_double),
    ("curvature_max", c_double),
]


class cw_bake_source(Structure):
    mesh: Any
    pictures: Any
    repeats: bool


cw_bake_source._fields_ = [
    ("mesh", POINTER(cw_mesh)),
    ("pictures", POINTER(cw_image) * 5),
    ("repeats", c_bool),
]


class cw_boolean_desc(Structure):
    version: int
    op: int
    threads: int
    progress: Any
    inputs: Any


cw_boolean_desc._fields_ = [
    ("version", c_uint32),
    ("op", c_int),
    ("threads", c_int),
    ("progress", cw_progress),
    ("inputs", POINTER(c_uint8)),
]


class cw_boolean_facts(Structure):
    version: int
    split_triangles: int
    new_points: int
    contact_edges: int
    contact_vertices: int
    dropped: int
    turned: int
    open_mesh: int
    rounds: int
    moved_mm: float
    volume_mm3: Any
    negative_regions: int
    negative_mm3: float


cw_boolean_facts._fields_ = [
    ("version", c_uint32),
    ("split_triangles", c_size_t),
    ("new_points", c_size_t),
    ("contact_edges", c_size_t),
    ("contact_vertices", c_size_t),
    ("dropped", c_size_t),
    ("turned", c_size_t),
    ("open_mesh", c_size_t),
    ("rounds", c_size_t),
    ("moved_mm", c_double),
    ("volume_mm3", c_double * 2),
    ("negative_regions", c_size_t),
    ("negative_mm3", c_double),
]


class cw_distance(Structure):
    max_mm: float
    rms_mm: float
    mean_mm: float
    p99_mm: float
    bias_mm: float
    bound_mm: float
    where: Any
    triangle: int
    triangles: int
    samples: int
    missed: int


cw_distance._fields_ = [
    ("max_mm", c_double),
    ("rms_mm", c_double),
    ("mean_mm", c_double),
    ("p99_mm", c_double),
    ("bias_mm", c_double),
    ("bound_mm", c_double),
    ("where", c_double * 3),
    ("triangle", c_size_t),
    ("triangles", c_size_t),
    ("samples", c_size_t),
    ("missed", c_size_t),
]


class cw_field_distance_desc(Structure):
    version: int
    isovalue: float
    inside_is_low: bool
    leave_open: bool
    reach_mm: float
    step_voxels: float
    worst: Any
    threads: int
    progress: Any


cw_field_distance_desc._fields_ = [
    ("version", c_uint32),
    ("isovalue", c_double),
    ("inside_is_low", c_bool),
    ("leave_open", c_bool),
    ("reach_mm", c_double),
    ("step_voxels", c_double),
    ("worst", POINTER(c_float)),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_mesh_distance_desc(Structure):
    version: int
    tolerance_mm: float
    step_mm: float
    vertices_only: bool
    worst: Any
    threads: int
    progress: Any


cw_mesh_distance_desc._fields_ = [
    ("version", c_uint32),
    ("tolerance_mm", c_double),
    ("step_mm", c_double),
    ("vertices_only", c_bool),
    ("worst", POINTER(c_float)),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_mesh_comparison(Structure):
    to_reference: Any
    from_reference: Any
    area_mm2: float
    reference_area_mm2: float


cw_mesh_comparison._fields_ = [
    ("to_reference", cw_distance),
    ("from_reference", cw_distance),
    ("area_mm2", c_double),
    ("reference_area_mm2", c_double),
]


class cw_print_desc(Structure):
    version: int
    min_wall_mm: float
    min_gap_mm: float
    overhang_deg: float
    layer_mm: float
    plate_mm: Any
    wall: Any
    gap: Any
    threads: int
    progress: Any


cw_print_desc._fields_ = [
    ("version", c_uint32),
    ("min_wall_mm", c_double),
    ("min_gap_mm", c_double),
    ("overhang_deg", c_double),
    ("layer_mm", c_double),
    ("plate_mm", c_double * 3),
    ("wall", POINTER(c_float)),
    ("gap", POINTER(c_float)),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_print_facts(Structure):
    limits: Any
    area_mm2: float
    wall_mm: float
    wall_at: Any
    thin_mm2: float
    gap_mm: float
    gap_at: Any
    narrow_mm2: float
    overhang_mm2: float
    islands: int
    island_at: Any
    trapped: int
    trapped_mm3: float
    volume_mm3: float
    center: Any
    foot_mm2: float
    margin_mm: float
    tip_deg: float
    fits: bool


cw_print_facts._fields_ = [
    ("limits", cw_print_desc),
    ("area_mm2", c_double),
    ("wall_mm", c_double),
    ("wall_at", c_double * 3),
    ("thin_mm2", c_double),
    ("gap_mm", c_double),
    ("gap_at", c_double * 3),
    ("narrow_mm2", c_double),
    ("overhang_mm2", c_double),
    ("islands", c_size_t),
    ("island_at", c_double * 3),
    ("trapped", c_size_t),
    ("trapped_mm3", c_double),
    ("volume_mm3", c_double),
    ("center", c_double * 3),
    ("foot_mm2", c_double),
    ("margin_mm", c_double),
    ("tip_deg", c_double),
    ("fits", c_bool),
]


class cw_print_stand(Structure):
    up: Any
    overhang_mm2: float
    height_mm: float
    hull_mm2: float
    tip_deg: float


cw_print_stand._fields_ = [
    ("up", c_double * 3),
    ("overhang_mm2", c_double),
    ("height_mm", c_double),
    ("hull_mm2", c_double),
    ("tip_deg", c_double),
]


class cw_orient_facts(Structure):
    before: Any
    after: Any
    matrix: Any
    directions: int
    poses: int
    unstable: int
    is_stable: bool
    is_kept: bool


cw_orient_facts._fields_ = [
    ("before", cw_print_stand),
    ("after", cw_print_stand),
    ("matrix", c_double * 12),
    ("directions", c_size_t),
    ("poses", c_size_t),
    ("unstable", c_size_t),
    ("is_stable", c_bool),
    ("is_kept", c_bool),
]


class cw_extract_desc(Structure):
    version: int
    isovalue: float
    inside_is_low: bool
    leave_open: bool
    simple_topology: bool
    cubic_placement: bool
    no_normals: bool
    snap: float
    threads: int
    max_triangles: int
    max_bytes: int
    extra_bytes: int
    progress: Any


cw_extract_desc._fields_ = [
    ("version", c_uint32),
    ("isovalue", c_double),
    ("inside_is_low", c_bool),
    ("leave_open", c_bool),
    ("simple_topology", c_bool),
    ("cubic_placement", c_bool),
    ("no_normals", c_bool),
    ("snap", c_double),
    ("threads", c_int),
    ("max_triangles", c_size_t),
    ("max_bytes", c_size_t),
    ("extra_bytes", c_size_t),
    ("progress", cw_progress),
]


class cw_snap_counts(Structure):
    vertices: int
    max_moved_mm: float
    max_moved_voxels: float
    max_error_mm: float
    max_error_voxels: float
    mean_error_mm: float
    mean_error_voxels: float


cw_snap_counts._fields_ = [
    ("vertices", c_size_t),
    ("max_moved_mm", c_double),
    ("max_moved_voxels", c_double),
    ("max_error_mm", c_double),
    ("max_error_voxels", c_double),
    ("mean_error_mm", c_double),
    ("mean_error_voxels", c_double),
]


class cw_extract_counts(Structure):
    vertices: int
    triangles: int
    border_loops: int
    bytes: int
    snap: Any


cw_extract_counts._fields_ = [
    ("vertices", c_size_t),
    ("triangles", c_size_t),
    ("border_loops", c_size_t),
    ("bytes", c_size_t),
    ("snap", cw_snap_counts),
]


class cw_extractor(Structure):
    pass


class cw_brick(Structure):
    mesh: Any
    at: Any
    count: Any
    index: int


cw_brick._fields_ = [
    ("mesh", POINTER(cw_mesh)),
    ("at", c_size_t * 3),
    ("count", c_size_t * 3),
    ("index", c_size_t),
]


class cw_brick_sink(Structure):
    take: Any
    user: Any


cw_brick_sink._fields_ = [
    ("take", CFUNCTYPE(c_int, c_void_p, POINTER(cw_brick), POINTER(cw_error))),
    ("user", c_void_p),
]


class cw_normals_desc(Structure):
    version: int
    inside_is_low: bool
    threads: int
    progress: Any


cw_normals_desc._fields_ = [
    ("version", c_uint32),
    ("inside_is_low", c_bool),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_slice_source(Structure):
    shape: Any
    read: Any
    user: Any


cw_slice_source._fields_ = [
    ("shape", cw_volume),
    ("read", CFUNCTYPE(c_int, c_void_p, c_size_t, c_size_t, c_void_p, POINTER(cw_error))),
    ("user", c_void_p),
]


class cw_mesh_chunk(Structure):
    mesh: Any
    first_vertex: int
    first_triangle: int


cw_mesh_chunk._fields_ = [
    ("mesh", cw_mesh),
    ("first_vertex", c_size_t),
    ("first_triangle", c_size_t),
]


class cw_chunk_sink(Structure):
    take: Any
    user: Any


cw_chunk_sink._fields_ = [
    ("take", CFUNCTYPE(c_int, c_void_p, POINTER(cw_mesh_chunk), POINTER(cw_error))),
    ("user", c_void_p),
]


class cw_stream_desc(Structure):
    version: int
    extract: Any
    layers: int


cw_stream_desc._fields_ = [
    ("version", c_uint32),
    ("extract", cw_extract_desc),
    ("layers", c_size_t),
]


class cw_part_counts(Structure):
    vertices: int
    triangles: int
    has_inside: bool
    has_outside: bool


cw_part_counts._fields_ = [
    ("vertices", c_size_t),
    ("triangles", c_size_t),
    ("has_inside", c_bool),
    ("has_outside", c_bool),
]


class cw_shapes(Structure):
    min_angle_deg: float
    max_angle_deg: float
    max_aspect: float
    min_edge_mm: float
    max_edge_mm: float
    angles: Any
    smallest: Any
    aspects: Any
    lengths: Any


cw_shapes._fields_ = [
    ("min_angle_deg", c_double),
    ("max_angle_deg", c_double),
    ("max_aspect", c_double),
    ("min_edge_mm", c_double),
    ("max_edge_mm", c_double),
    ("angles", c_size_t * 18),
    ("smallest", c_size_t * 18),
    ("aspects", c_size_t * 9),
    ("lengths", c_size_t * 20),
]


class cw_quality(Structure):
    vertices: int
    triangles: int
    edges: int
    components: int
    unused_vertices: int
    merged_vertices: int
    open_edges: int
    border_loops: int
    nonmanifold_edges: int
    contact_edges: int
    misoriented_edges: int
    nonmanifold_vertices: int
    contact_vertices: int
    duplicates: int
    degenerate: int
    needles: int
    caps: int
    cavities: int
    inside_out: int
    nested: int
    open_inward: int
    one_sided: int
    to_turn: int
    euler: int
    genus: int
    area_mm2: float
    volume_mm3: float
    min: Any
    max: Any
    shapes: Any


cw_quality._fields_ = [
    ("vertices", c_size_t),
    ("triangles", c_size_t),
    ("edges", c_size_t),
    ("components", c_size_t),
    ("unused_vertices", c_size_t),
    ("merged_vertices", c_size_t),
    ("open_edges", c_size_t),
    ("border_loops", c_size_t),
    ("nonmanifold_edges", c_size_t),
    ("contact_edges", c_size_t),
    ("misoriented_edges", c_size_t),
    ("nonmanifold_vertices", c_size_t),
    ("contact_vertices", c_size_t),
    ("duplicates", c_size_t),
    ("degenerate", c_size_t),
    ("needles", c_size_t),
    ("caps", c_size_t),
    ("cavities", c_size_t),
    ("inside_out", c_size_t),
    ("nested", c_size_t),
    ("open_inward", c_size_t),
    ("one_sided", c_size_t),
    ("to_turn", c_size_t),
    ("euler", c_int64),
    ("genus", c_int64),
    ("area_mm2", c_double),
    ("volume_mm3", c_double),
    ("min", c_double * 3),
    ("max", c_double * 3),
    ("shapes", cw_shapes),
]


class cw_quality_desc(Structure):
    version: int
    weld: int
    shells: bool
    threads: int
    defects: Any
    progress: Any
    turn: Any


cw_quality_desc._fields_ = [
    ("version", c_uint32),
    ("weld", c_int),
    ("shells", c_bool),
    ("threads", c_int),
    ("defects", POINTER(c_uint8)),
    ("progress", cw_progress),
    ("turn", POINTER(c_uint8)),
]


class cw_quality_stream(Structure):
    pass


class cw_quality_stream_desc(Structure):
    version: int
    threads: int
    max_bytes: int


cw_quality_stream_desc._fields_ = [
    ("version", c_uint32),
    ("threads", c_int),
    ("max_bytes", c_size_t),
]


class cw_orient_counts(Structure):
    turned: int
    triangles: int


cw_orient_counts._fields_ = [
    ("turned", c_size_t),
    ("triangles", c_size_t),
]


class cw_crossings_desc(Structure):
    version: int
    weld: int
    threads: int
    defects: Any
    progress: Any


cw_crossings_desc._fields_ = [
    ("version", c_uint32),
    ("weld", c_int),
    ("threads", c_int),
    ("defects", POINTER(c_uint8)),
    ("progress", cw_progress),
]


class cw_crossings(Structure):
    count: int
    pairs: Any
    undecided: bool


cw_crossings._fields_ = [
    ("count", c_size_t),
    ("pairs", POINTER(c_uint32)),
    ("undecided", c_bool),
]


class cw_cgal_facts(Structure):
    is_polygon_mesh: bool
    closed: bool
    bounds_volume: bool
    outward: bool
    components: int
    border_loops: int
    self_intersections: int
    degenerate: int
    needles: int
    caps: int
    area_mm2: float
    volume_mm3: float


cw_cgal_facts._fields_ = [
    ("is_polygon_mesh", c_bool),
    ("closed", c_bool),
    ("bounds_volume", c_bool),
    ("outward", c_bool),
    ("components", c_size_t),
    ("border_loops", c_size_t),
    ("self_intersections", c_size_t),
    ("degenerate", c_size_t),
    ("needles", c_size_t),
    ("caps", c_size_t),
    ("area_mm2", c_double),
    ("volume_mm3", c_double),
]


class cw_findings(Structure):
    quality: Any
    crossings: Any
    cgal: Any
    print: Any
    to_field: Any
    from_field: Any
    field: Any
    missing: int
    missing_mm3: float
    missing_mm: float
    to_reference: Any
    from_reference: Any
    tolerance_mm: float
    has_normals: bool
    file_fault: bytes | None
    file_bytes: int
    looks: Any
    bare_looks: Any
    max_delta_e: float
    min_psnr_db: float
    orient: Any


cw_findings._fields_ = [
    ("quality", POINTER(cw_quality)),
    ("crossings", POINTER(cw_crossings)),
    ("cgal", POINTER(cw_cgal_facts)),
    ("print", POINTER(cw_print_facts)),
    ("to_field", POINTER(cw_distance)),
    ("from_field", POINTER(cw_distance)),
    ("field", POINTER(cw_quality)),
    ("missing", c_size_t),
    ("missing_mm3", c_double),
    ("missing_mm", c_double),
    ("to_reference", POINTER(cw_distance)),
    ("from_reference", POINTER(cw_distance)),
    ("tolerance_mm", c_double),
    ("has_normals", c_bool),
    ("file_fault", c_char_p),
    ("file_bytes", c_size_t),
    ("looks", POINTER(cw_appearance)),
    ("bare_looks", POINTER(cw_appearance)),
    ("max_delta_e", c_double),
    ("min_psnr_db", c_double),
    ("orient", POINTER(cw_orient_facts)),
]


class cw_budget(Structure):
    triangles: Any
    texture_size: int
    file_bytes: int


cw_budget._fields_ = [
    ("triangles", c_size_t * 4),
    ("texture_size", c_uint32),
    ("file_bytes", c_size_t),
]


class cw_verdict(Structure):
    name: bytes | None
    grade: int
    number: float
    text: Any
    advice: bytes | None


cw_verdict._fields_ = [
    ("name", c_char_p),
    ("grade", c_int),
    ("number", c_double),
    ("text", c_char * 200),
    ("advice", c_char_p),
]


class cw_contacts(Structure):
    triangles: int
    shared: int
    overlapping: int
    neighbours: int


cw_contacts._fields_ = [
    ("triangles", c_size_t),
    ("shared", c_size_t),
    ("overlapping", c_size_t),
    ("neighbours", c_size_t),
]


class cw_paint(Structure):
    defect: int
    name: bytes | None
    color: bytes | None
    rgb: Any


cw_paint._fields_ = [
    ("defect", c_int),
    ("name", c_char_p),
    ("color", c_char_p),
    ("rgb", c_uint8 * 3),
]


class cw_sample_desc(Structure):
    version: int
    threads: int
    progress: Any


cw_sample_desc._fields_ = [
    ("version", c_uint32),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_sample_facts(Structure):
    low: float
    high: float
    missing: int


cw_sample_facts._fields_ = [
    ("low", c_double),
    ("high", c_double),
    ("missing", c_size_t),
]


class cw_cut_desc(Structure):
    version: int
    point: Any
    normal: Any
    point_is_percent: bool
    leave_open: bool
    progress: Any


cw_cut_desc._fields_ = [
    ("version", c_uint32),
    ("point", c_double * 3),
    ("normal", c_double * 3),
    ("point_is_percent", c_bool),
    ("leave_open", c_bool),
    ("progress", cw_progress),
]


class cw_cut_facts(Structure):
    cut_triangles: int
    dropped_triangles: int
    cap_triangles: int
    loops_closed: int
    loops_open: int
    area_mm2: float
    moved_mm: float


cw_cut_facts._fields_ = [
    ("cut_triangles", c_size_t),
    ("dropped_triangles", c_size_t),
    ("cap_triangles", c_size_t),
    ("loops_closed", c_size_t),
    ("loops_open", c_size_t),
    ("area_mm2", c_double),
    ("moved_mm", c_double),
]


class cw_engrave_desc(Structure):
    version: int
    text: bytes | None
    size_mm: float
    depth_mm: float
    stroke_mm: float
    wall_mm: float
    emboss: bool
    has_at: bool
    at: Any
    direction: Any
    threads: int
    progress: Any


cw_engrave_desc._fields_ = [
    ("version", c_uint32),
    ("text", c_char_p),
    ("size_mm", c_double),
    ("depth_mm", c_double),
    ("stroke_mm", c_double),
    ("wall_mm", c_double),
    ("emboss", c_bool),
    ("has_at", c_bool),
    ("at", c_double * 3),
    ("direction", c_double * 3),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_engrave_facts(Structure):
    version: int
    center: Any
    normal: Any
    right: Any
    size_mm: float
    stroke_mm: float
    depth_mm: float
    wall_mm: float
    width_mm: float
    height_mm: float
    deviation_mm: float
    lean_deg: float
    thickness_mm: float
    volume_mm3: float
    characters: int


cw_engrave_facts._fields_ = [
    ("version", c_uint32),
    ("center", c_double * 3),
    ("normal", c_double * 3),
    ("right", c_double * 3),
    ("size_mm", c_double),
    ("stroke_mm", c_double),
    ("depth_mm", c_double),
    ("wall_mm", c_double),
    ("width_mm", c_double),
    ("height_mm", c_double),
    ("deviation_mm", c_double),
    ("lean_deg", c_double),
    ("thickness_mm", c_double),
    ("volume_mm3", c_double),
    ("characters", c_size_t),
]


class cw_field_desc(Structure):
    version: int
    field: int
    dim: Any
    type: int
    noise: float
    seed: int
    threads: int
    progress: Any


cw_field_desc._fields_ = [
    ("version", c_uint32),
    ("field", c_int),
    ("dim", c_size_t * 3),
    ("type", c_int),
    ("noise", c_double),
    ("seed", c_uint64),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_label_field_desc(Structure):
    version: int
    field: int
    dim: Any
    type: int
    labels: int
    seed: int
    threads: int
    progress: Any


cw_label_field_desc._fields_ = [
    ("version", c_uint32),
    ("field", c_int),
    ("dim", c_size_t * 3),
    ("type", c_int),
    ("labels", c_size_t),
    ("seed", c_uint64),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_field_error(Structure):
    samples: int
    missed: int
    max_mm: float
    rms_mm: float
    p99_mm: float


cw_field_error._fields_ = [
    ("samples", c_size_t),
    ("missed", c_size_t),
    ("max_mm", c_double),
    ("rms_mm", c_double),
    ("p99_mm", c_double),
]


class cw_field_vertex_error(Structure):
    count: int
    missed: int
    mean_mm: float
    max_mm: float
    has_normals: bool
    mean_deg: float
    max_deg: float


cw_field_vertex_error._fields_ = [
    ("count", c_size_t),
    ("missed", c_size_t),
    ("mean_mm", c_double),
    ("max_mm", c_double),
    ("has_normals", c_bool),
    ("mean_deg", c_double),
    ("max_deg", c_double),
]


class cw_filter_desc(Structure):
    version: int
    threads: int
    max_bytes: int
    progress: Any


cw_filter_desc._fields_ = [
    ("version", c_uint32),
    ("threads", c_int),
    ("max_bytes", c_size_t),
    ("progress", cw_progress),
]


class cw_inside(Structure):
    level: float
    inside_is_low: bool


cw_inside._fields_ = [
    ("level", c_double),
    ("inside_is_low", c_bool),
]


class cw_code(Structure):
    scheme: Any
    value: Any
    meaning: Any


cw_code._fields_ = [
    ("scheme", POINTER(c_char)),
    ("value", POINTER(c_char)),
    ("meaning", POINTER(c_char)),
]


class cw_label(Structure):
    value: int
    layer: int
    name: Any
    color: Any
    has_color: bool
    hidden: bool
    category: Any
    type: Any
    id: int
    is_negative: bool


cw_label._fields_ = [
    ("value", c_uint32),
    ("layer", c_uint32),
    ("name", POINTER(c_char)),
    ("color", c_uint8 * 4),
    ("has_color", c_bool),
    ("hidden", c_bool),
    ("category", cw_code),
    ("type", cw_code),
    ("id", c_uint64),
    ("is_negative", c_bool),
]


class cw_label_table(Structure):
    count: int
    labels: Any


cw_label_table._fields_ = [
    ("count", c_size_t),
    ("labels", POINTER(cw_label)),
]


class cw_label_ids(Structure):
    count: int
    ids: Any
    is_unsigned: bool
    rounded: int
    largest_rounding: float


cw_label_ids._fields_ = [
    ("count", c_size_t),
    ("ids", POINTER(c_int64)),
    ("is_unsigned", c_bool),
    ("rounded", c_size_t),
    ("largest_rounding", c_double),
]


class cw_team(Structure):
    rank: int
    size: int
    on_this_host: int
    gather: Any
    broadcast: Any
    user: Any


cw_team._fields_ = [
    ("rank", c_int),
    ("size", c_int),
    ("on_this_host", c_int),
    ("gather", CFUNCTYPE(c_int, c_void_p, c_void_p, c_size_t, c_void_p, POINTER(cw_error))),
    ("broadcast", CFUNCTYPE(c_int, c_void_p, c_int, c_void_p, c_size_t, POINTER(cw_error))),
    ("user", c_void_p),
]


class cw_mesh_spool(Structure):
    pass


class cw_spool_drop_desc(Structure):
    version: int
    least_mm3: float
    max_bytes: int
    progress: Any


cw_spool_drop_desc._fields_ = [
    ("version", c_uint32),
    ("least_mm3", c_double),
    ("max_bytes", c_size_t),
    ("progress", cw_progress),
]


class cw_fragment(Structure):
    part: int
    parts: int
    counts: Any
    job: int


cw_fragment._fields_ = [
    ("part", c_size_t),
    ("parts", c_size_t),
    ("counts", cw_part_counts),
    ("job", c_uint64),
]


class cw_byte_source(Structure):
    version: int
    name: bytes | None
    bytes: Any
    size: int
    read: Any
    user: Any
    max_bytes: int
    folder: bytes | None


cw_byte_source._fields_ = [
    ("version", c_uint32),
    ("name", c_char_p),
    ("bytes", c_void_p),
    ("size", c_uint64),
    ("read", CFUNCTYPE(c_int, c_void_p, c_void_p, c_size_t, POINTER(c_size_t), POINTER(cw_error))),
    ("user", c_void_p),
    ("max_bytes", c_uint64),
    ("folder", c_char_p),
]


class cw_stored_file(Structure):
    pass


class cw_byte_sink(Structure):
    version: int
    begin: Any
    write: Any
    user: Any
    folder: bytes | None


cw_byte_sink._fields_ = [
    ("version", c_uint32),
    ("begin", CFUNCTYPE(c_int, c_void_p, c_uint64, POINTER(cw_error))),
    ("write", CFUNCTYPE(c_int, c_void_p, c_void_p, c_size_t, POINTER(cw_error))),
    ("user", c_void_p),
    ("folder", c_char_p),
]


class cw_raw_layout(Structure):
    dim: Any
    type: int
    components: int
    steps: int
    big_endian: bool
    offset: int
    spacing: Any
    stored_bytes: int


cw_raw_layout._fields_ = [
    ("dim", c_size_t * 3),
    ("type", c_int),
    ("components", c_size_t),
    ("steps", c_size_t),
    ("big_endian", c_bool),
    ("offset", c_uint64),
    ("spacing", c_double * 3),
    ("stored_bytes", c_size_t),
]


class cw_axes(Structure):
    unit: int
    ras: bool
    y_up: bool


cw_axes._fields_ = [
    ("unit", c_int),
    ("ras", c_bool),
    ("y_up", c_bool),
]


class cw_claim(Structure):
    has_unit: bool
    has_frame: bool
    has_up: bool
    axes: Any
    rule: int


cw_claim._fields_ = [
    ("has_unit", c_bool),
    ("has_frame", c_bool),
    ("has_up", c_bool),
    ("axes", cw_axes),
    ("rule", c_int),
]


class cw_read_desc(Structure):
    version: int
    reader: bytes | None
    raw: Any
    header_only: bool
    allow_external: bool
    region: Any
    every: Any
    max_voxels: int
    max_bytes: int
    spacing_mm: Any
    claim: Any
    array: bytes | None
    level: int
    labels: Any
    points: bytes | None
    series: bytes | None
    gaps: int
    tilt: int
    skip_damaged: bool
    no_sandbox: bool
    timeout_s: float
    note: Any
    note_user: Any
    progress: Any
    nodata: int
    nodata_value: float
    ids: Any
    round_labels: bool
    stored: Any


cw_read_desc._fields_ = [
    ("version", c_uint32),
    ("reader", c_char_p),
    ("raw", POINTER(cw_raw_layout)),
    ("header_only", c_bool),
    ("allow_external", c_bool),
    ("region", POINTER(cw_box)),
    ("every", c_size_t * 3),
    ("max_voxels", c_uint64),
    ("max_bytes", c_uint64),
    ("spacing_mm", c_double * 3),
    ("claim", cw_claim),
    ("array", c_char_p),
    ("level", c_size_t),
    ("labels", POINTER(cw_label_table)),
    ("points", c_char_p),
    ("series", c_char_p),
    ("gaps", c_int),
    ("tilt", c_int),
    ("skip_damaged", c_bool),
    ("no_sandbox", c_bool),
    ("timeout_s", c_double),
    ("note", CFUNCTYPE(None, c_void_p, c_char_p)),
    ("note_user", c_void_p),
    ("progress", cw_progress),
    ("nodata", c_int),
    ("nodata_value", c_double),
    ("ids", POINTER(cw_label_ids)),
    ("round_labels", c_bool),
    ("stored", POINTER(cw_stored_file)),
]


class cw_slice_visitor(Structure):
    visit: Any
    user: Any


cw_slice_visitor._fields_ = [
    ("visit", CFUNCTYPE(c_int, c_void_p, POINTER(cw_slice_source), POINTER(cw_error))),
    ("user", c_void_p),
]


class cw_array(Structure):
    name: Any
    type: Any
    components: int
    of_cells: bool
    is_read: bool
    is_default: bool


cw_array._fields_ = [
    ("name", c_char * 64),
    ("type", c_char * 32),
    ("components", c_size_t),
    ("of_cells", c_bool),
    ("is_read", c_bool),
    ("is_default", c_bool),
]


class cw_level(Structure):
    name: Any
    axes: Any
    shape: Any


cw_level._fields_ = [
    ("name", c_char * 64),
    ("axes", c_char * 64),
    ("shape", cw_volume),
]


class cw_series(Structure):
    label: Any
    modality: Any
    images: int
    shape: Any
    tilt_degrees: float
    status: int
    finding: Any


cw_series._fields_ = [
    ("label", c_char * 32),
    ("modality", c_char * 20),
    ("images", c_size_t),
    ("shape", cw_volume),
    ("tilt_degrees", c_double),
    ("status", c_int),
    ("finding", c_char * 512),
]


class cw_mesh_read_desc(Structure):
    version: int
    reader: bytes | None
    allow_external: bool
    max_triangles: int
    max_bytes: int
    no_sandbox: bool
    timeout_s: float
    truncated: bool
    claim: Any
    progress: Any
    stored: Any


cw_mesh_read_desc._fields_ = [
    ("version", c_uint32),
    ("reader", c_char_p),
    ("allow_external", c_bool),
    ("max_triangles", c_uint64),
    ("max_bytes", c_uint64),
    ("no_sandbox", c_bool),
    ("timeout_s", c_double),
    ("truncated", c_bool),
    ("claim", cw_claim),
    ("progress", cw_progress),
    ("stored", POINTER(cw_stored_file)),
]


class cw_mesh_file(Structure):
    format: bytes | None
    known: int
    axes: Any
    local: bool
    parts: int
    polygons: int
    skipped: int
    levels: int
    hidden: int
    supports: int
    support_triangles: int
    others: int
    other_triangles: int
    truncated: bool
    expected_triangles: int
    fault: Any
    crossing: int
    left_out: Any
    miscounted: bool
    attribute_bytes: int
    not_applied: Any
    modifier_triangles: int
    invisible: int
    invisible_names: Any
    pieces: int
    merged_vertices: int
    marked_cells: int
    placed: Any


cw_mesh_file._fields_ = [
    ("format", c_char_p),
    ("known", c_uint),
    ("axes", cw_axes),
    ("local", c_bool),
    ("parts", c_size_t),
    ("polygons", c_size_t),
    ("skipped", c_size_t),
    ("levels", c_size_t),
    ("hidden", c_size_t),
    ("supports", c_size_t),
    ("support_triangles", c_size_t),
    ("others", c_size_t),
    ("other_triangles", c_size_t),
    ("truncated", c_bool),
    ("expected_triangles", c_size_t),
    ("fault", c_char * 160),
    ("crossing", c_size_t),
    ("left_out", c_char * 128),
    ("miscounted", c_bool),
    ("attribute_bytes", c_uint64),
    ("not_applied", c_char * 160),
    ("modifier_triangles", c_size_t),
    ("invisible", c_size_t),
    ("invisible_names", c_char * 160),
    ("pieces", c_size_t),
    ("merged_vertices", c_size_t),
    ("marked_cells", c_size_t),
    ("placed", c_char * 128),
]


class cw_texture(Structure):
    bytes: Any
    size: int


cw_texture._fields_ = [
    ("bytes", POINTER(c_uint8)),
    ("size", c_size_t),
]


class cw_textures(Structure):
    version: int
    normal: Any
    color: Any
    metallic_roughness: Any
    occlusion: Any
    emissive: Any
    has_factors: bool
    color_factor: Any
    metallic_factor: float
    roughness_factor: float
    emissive_factor: Any
    normal_scale: float
    occlusion_strength: float
    repeats: bool


cw_textures._fields_ = [
    ("version", c_uint32),
    ("normal", cw_texture),
    ("color", cw_texture),
    ("metallic_roughness", cw_texture),
    ("occlusion", cw_texture),
    ("emissive", cw_texture),
    ("has_factors", c_bool),
    ("color_factor", c_float * 4),
    ("metallic_factor", c_float),
    ("roughness_factor", c_float),
    ("emissive_factor", c_float * 3),
    ("normal_scale", c_float),
    ("occlusion_strength", c_float),
    ("repeats", c_bool),
]


class cw_part(Structure):
    mesh: Any
    name: bytes | None
    label: Any
    level: int
    max_error_mm: float
    rms_error_mm: float
    time_s: float
    spool: Any
    textures: Any


cw_part._fields_ = [
    ("mesh", POINTER(cw_mesh)),
    ("name", c_char_p),
    ("label", POINTER(cw_label)),
    ("level", c_size_t),
    ("max_error_mm", c_double),
    ("rms_error_mm", c_double),
    ("time_s", c_double),
    ("spool", POINTER(cw_mesh_spool)),
    ("textures", POINTER(cw_textures)),
]


class cw_compressed(Structure):
    bits: int
    step_mm: float
    error_mm: float
    normal_degrees: float
    merged: int
    flat: int
    dropped: int
    fragments: int
    bytes: int
    encode_s: float
    decode_s: float
    settled: int


cw_compressed._fields_ = [
    ("bits", c_int),
    ("step_mm", c_double),
    ("error_mm", c_double),
    ("normal_degrees", c_double),
    ("merged", c_size_t),
    ("flat", c_size_t),
    ("dropped", c_size_t),
    ("fragments", c_size_t),
    ("bytes", c_uint64),
    ("encode_s", c_double),
    ("decode_s", c_double),
    ("settled", c_size_t),
]


class cw_provenance(Structure):
    key: bytes | None
    value: bytes | None


cw_provenance._fields_ = [
    ("key", c_char_p),
    ("value", c_char_p),
]


class cw_write_desc(Structure):
    version: int
    format: bytes | None
    name: bytes | None
    no_clobber: bool
    local: bool
    axes: Any
    text: bool
    compression: int
    tolerance_mm: float
    bits: int
    level: int
    compressed: Any
    animated: bool
    sides: Any
    provenance: Any
    provenance_count: int
    progress: Any
    labels: Any
    sink: Any


cw_write_desc._fields_ = [
    ("version", c_uint32),
    ("format", c_char_p),
    ("name", c_char_p),
    ("no_clobber", c_bool),
    ("local", c_bool),
    ("axes", cw_axes),
    ("text", c_bool),
    ("compression", c_int),
    ("tolerance_mm", c_double),
    ("bits", c_int),
    ("level", c_int),
    ("compressed", POINTER(cw_compressed)),
    ("animated", c_bool),
    ("sides", POINTER(c_uint32)),
    ("provenance", POINTER(cw_provenance)),
    ("provenance_count", c_size_t),
    ("progress", cw_progress),
    ("labels", POINTER(cw_label_table)),
    ("sink", POINTER(cw_byte_sink)),
]


class cw_write_consent(Structure):
    ask: Any
    user: Any


cw_write_consent._fields_ = [
    ("ask", CFUNCTYPE(c_int, c_void_p, POINTER(cw_error))),
    ("user", c_void_p),
]


class cw_write_loss(Structure):
    step_mm: float
    merged_vertices: int
    flat_triangles: int
    dropped: int
    attributes: Any
    split_vertices: int
    rounded_colors: int


cw_write_loss._fields_ = [
    ("step_mm", c_double),
    ("merged_vertices", c_size_t),
    ("flat_triangles", c_size_t),
    ("dropped", c_uint),
    ("attributes", c_char * 256),
    ("split_vertices", c_size_t),
    ("rounded_colors", c_size_t),
]


class cw_pvd_entry(Structure):
    path: bytes | None
    time: float


cw_pvd_entry._fields_ = [
    ("path", c_char_p),
    ("time", c_double),
]


class cw_format(Structure):
    name: bytes | None
    extensions: bytes | None
    about: bytes | None
    reads_volume: bool
    writes_volume: bool
    reads_mesh: bool
    writes_mesh: bool
    in_this_build: bool
    reason: bytes | None
    lost: bytes | None
    keeps: int


cw_format._fields_ = [
    ("name", c_char_p),
    ("extensions", c_char_p),
    ("about", c_char_p),
    ("reads_volume", c_bool),
    ("writes_volume", c_bool),
    ("reads_mesh", c_bool),
    ("writes_mesh", c_bool),
    ("in_this_build", c_bool),
    ("reason", c_char_p),
    ("lost", c_char_p),
    ("keeps", c_uint),
]


class cw_close_handles_desc(Structure):
    version: int
    length_mm: float
    threads: int
    progress: Any


cw_close_handles_desc._fields_ = [
    ("version", c_uint32),
    ("length_mm", c_double),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_close_handles_facts(Structure):
    length_mm: float
    genus_before: int
    genus_after: int
    cut: int
    filled: int
    left_long: int
    left_crossing: int
    change_mm: float
    triangles_before: int
    triangles_after: int
    components_before: int
    components_after: int


cw_close_handles_facts._fields_ = [
    ("length_mm", c_double),
    ("genus_before", c_size_t),
    ("genus_after", c_size_t),
    ("cut", c_size_t),
    ("filled", c_size_t),
    ("left_long", c_size_t),
    ("left_crossing", c_size_t),
    ("change_mm", c_double),
    ("triangles_before", c_size_t),
    ("triangles_after", c_size_t),
    ("components_before", c_size_t),
    ("components_after", c_size_t),
]


class cw_hard(Structure):
    name: bytes | None
    about: bytes | None
    isovalue: float
    scale: float
    spacing_mm: float
    first_mm: float


cw_hard._fields_ = [
    ("name", c_char_p),
    ("about", c_char_p),
    ("isovalue", c_double),
    ("scale", c_double),
    ("spacing_mm", c_double),
    ("first_mm", c_double),
]


class cw_hard_desc(Structure):
    version: int
    number: int
    dim: Any
    type: int
    noise: float
    seed: int
    threads: int
    progress: Any


cw_hard_desc._fields_ = [
    ("version", c_uint32),
    ("number", c_size_t),
    ("dim", c_size_t * 3),
    ("type", c_int),
    ("noise", c_double),
    ("seed", c_uint64),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_labels_desc(Structure):
    version: int
    labels: Any
    label_count: int
    background: int
    no_smoothing: bool
    max_move: float
    leave_open: bool
    threads: int
    max_triangles: int
    progress: Any


cw_labels_desc._fields_ = [
    ("version", c_uint32),
    ("labels", POINTER(c_uint32)),
    ("label_count", c_size_t),
    ("background", c_uint32),
    ("no_smoothing", c_bool),
    ("max_move", c_double),
    ("leave_open", c_bool),
    ("threads", c_int),
    ("max_triangles", c_size_t),
    ("progress", cw_progress),
]


class cw_label_patch(Structure):
    labels: Any
    first: int
    count: int


cw_label_patch._fields_ = [
    ("labels", c_uint32 * 2),
    ("first", c_size_t),
    ("count", c_size_t),
]


class cw_label_count(Structure):
    label: int
    voxels: int


cw_label_count._fields_ = [
    ("label", c_uint32),
    ("voxels", c_size_t),
]


class cw_label_surfaces(Structure):
    mesh: Any
    patch_count: int
    patches: Any
    label_count: int
    labels: Any
    background: int


cw_label_surfaces._fields_ = [
    ("mesh", cw_mesh),
    ("patch_count", c_size_t),
    ("patches", POINTER(cw_label_patch)),
    ("label_count", c_size_t),
    ("labels", POINTER(cw_label_count)),
    ("background", c_uint32),
]


class cw_label_prediction(Structure):
    labels: int
    patches: int
    vertices: int
    triangles: int
    own_triangles: int
    bytes: int


cw_label_prediction._fields_ = [
    ("labels", c_size_t),
    ("patches", c_size_t),
    ("vertices", c_size_t),
    ("triangles", c_size_t),
    ("own_triangles", c_size_t),
    ("bytes", c_size_t),
]


class cw_label_scores(Structure):
    version: int
    fields: Any
    count: int
    labels: Any
    names: Any
    rule: int
    value: float
    has_value: bool


cw_label_scores._fields_ = [
    ("version", c_uint32),
    ("fields", POINTER(cw_volume)),
    ("count", c_size_t),
    ("labels", POINTER(c_uint32)),
    ("names", POINTER(c_char_p)),
    ("rule", c_int),
    ("value", c_double),
    ("has_value", c_bool),
]


class cw_label_clean_desc(Structure):
    version: int
    background: int
    min_voxels: int
    largest: int
    fill_voids: bool


cw_label_clean_desc._fields_ = [
    ("version", c_uint32),
    ("background", c_uint32),
    ("min_voxels", c_size_t),
    ("largest", c_size_t),
    ("fill_voids", c_bool),
]


class cw_label_change(Structure):
    label: int
    voxels_before: int
    voxels: int
    components_removed: int
    voxels_removed: int
    voxels_added: int


cw_label_change._fields_ = [
    ("label", c_uint32),
    ("voxels_before", c_size_t),
    ("voxels", c_size_t),
    ("components_removed", c_size_t),
    ("voxels_removed", c_size_t),
    ("voxels_added", c_size_t),
]


class cw_label_resample_desc(Structure):
    version: int
    spacing_mm: Any
    kernel: int
    background: int
    threads: int
    max_bytes: int
    progress: Any


cw_label_resample_desc._fields_ = [
    ("version", c_uint32),
    ("spacing_mm", c_double * 3),
    ("kernel", c_int),
    ("background", c_uint32),
    ("threads", c_int),
    ("max_bytes", c_size_t),
    ("progress", cw_progress),
]


class cw_label_simplify_desc(Structure):
    version: int
    error_mm: float
    triangles: int
    ratio: float
    threads: int
    progress: Any


cw_label_simplify_desc._fields_ = [
    ("version", c_uint32),
    ("error_mm", c_double),
    ("triangles", c_size_t),
    ("ratio", c_double),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_level_set_desc(Structure):
    version: int
    voxel_mm: float
    inside_mm: float
    outside_mm: float
    threads: int
    max_bytes: int
    progress: Any


cw_level_set_desc._fields_ = [
    ("version", c_uint32),
    ("voxel_mm", c_double),
    ("inside_mm", c_double),
    ("outside_mm", c_double),
    ("threads", c_int),
    ("max_bytes", c_size_t),
    ("progress", cw_progress),
]


class cw_offset_desc(Structure):
    version: int
    offset_mm: float
    voxel_mm: float
    no_sharpen: bool
    no_refine: bool
    threads: int
    max_bytes: int
    progress: Any


cw_offset_desc._fields_ = [
    ("version", c_uint32),
    ("offset_mm", c_double),
    ("voxel_mm", c_double),
    ("no_sharpen", c_bool),
    ("no_refine", c_bool),
    ("threads", c_int),
    ("max_bytes", c_size_t),
    ("progress", cw_progress),
]


class cw_offset_facts(Structure):
    voxel_mm: float
    asked_mm: float
    least_mm: float
    is_astray: bool
    more_components: int
    more_handles: int


cw_offset_facts._fields_ = [
    ("voxel_mm", c_double),
    ("asked_mm", c_double),
    ("least_mm", c_double),
    ("is_astray", c_bool),
    ("more_components", c_size_t),
    ("more_handles", c_size_t),
]


class cw_drain(Structure):
    diameter_mm: float
    direction: Any


cw_drain._fields_ = [
    ("diameter_mm", c_double),
    ("direction", c_double * 3),
]


class cw_infill_desc(Structure):
    version: int
    kind: int
    cell_mm: float
    wall_mm: float
    end_wall_mm: float
    depth_mm: float
    by: Any


cw_infill_desc._fields_ = [
    ("version", c_uint32),
    ("kind", c_int),
    ("cell_mm", c_double),
    ("wall_mm", c_double),
    ("end_wall_mm", c_double),
    ("depth_mm", c_double),
    ("by", POINTER(cw_volume)),
]


class cw_hollow_desc(Structure):
    version: int
    wall_mm: float
    drains: Any
    drain_count: int
    voxel_mm: float
    no_measure: bool
    threads: int
    max_bytes: int
    progress: Any
    infill: Any


cw_hollow_desc._fields_ = [
    ("version", c_uint32),
    ("wall_mm", c_double),
    ("drains", POINTER(cw_drain)),
    ("drain_count", c_size_t),
    ("voxel_mm", c_double),
    ("no_measure", c_bool),
    ("threads", c_int),
    ("max_bytes", c_size_t),
    ("progress", cw_progress),
    ("infill", POINTER(cw_infill_desc)),
]


class cw_hollow_facts(Structure):
    voxel_mm: float
    cavities: int
    sealed: int
    filled: int
    filled_mm3: float
    removed_mm3: float
    wall_min_mm: float
    wall_max_mm: float
    drains: int
    loose: int
    infill_samples: int
    infill_min_mm: float
    infill_median_mm: float
    infill_max_mm: float


cw_hollow_facts._fields_ = [
    ("voxel_mm", c_double),
    ("cavities", c_size_t),
    ("sealed", c_size_t),
    ("filled", c_size_t),
    ("filled_mm3", c_double),
    ("removed_mm3", c_double),
    ("wall_min_mm", c_double),
    ("wall_max_mm", c_double),
    ("drains", c_size_t),
    ("loose", c_size_t),
    ("infill_samples", c_size_t),
    ("infill_min_mm", c_double),
    ("infill_median_mm", c_double),
    ("infill_max_mm", c_double),
]


class cw_color_point(Structure):
    value: float
    color: Any


cw_color_point._fields_ = [
    ("value", c_double),
    ("color", c_float * 3),
]


class cw_opacity_point(Structure):
    value: float
    opacity: float


cw_opacity_point._fields_ = [
    ("value", c_double),
    ("opacity", c_float),
]


class cw_index_point(Structure):
    value: float
    index: float


cw_index_point._fields_ = [
    ("value", c_double),
    ("index", c_float),
]


class cw_transfer(Structure):
    color_count: int
    opacity_count: int
    gradient_count: int
    index_count: int
    colors: Any
    opacities: Any
    gradients: Any
    indices: Any
    surface_mm: float
    unit_mm: float


cw_transfer._fields_ = [
    ("color_count", c_size_t),
    ("opacity_count", c_size_t),
    ("gradient_count", c_size_t),
    ("index_count", c_size_t),
    ("colors", cw_color_point * 64),
    ("opacities", cw_opacity_point * 64),
    ("gradients", cw_opacity_point * 64),
    ("indices", cw_index_point * 64),
    ("surface_mm", c_double),
    ("unit_mm", c_double),
]


class cw_material_class(Structure):
    values: Any
    color: Any
    opacity: float
    index: float


cw_material_class._fields_ = [
    ("values", c_double * 4),
    ("color", c_float * 3),
    ("opacity", c_float),
    ("index", c_float),
]


class cw_light(Structure):
    direction: Any
    color: Any


cw_light._fields_ = [
    ("direction", c_double * 3),
    ("color", c_float * 3),
]


class cw_clip(Structure):
    normal: Any
    distance_mm: float


cw_clip._fields_ = [
    ("normal", c_double * 3),
    ("distance_mm", c_double),
]


class cw_material(Structure):
    ambient: float
    diffuse: float
    specular: float
    shininess: float


cw_material._fields_ = [
    ("ambient", c_float),
    ("diffuse", c_float),
    ("specular", c_float),
    ("shininess", c_float),
]


class cw_live_surface(Structure):
    volume: Any
    isovalue: float
    inside_is_low: bool
    on_software: bool


cw_live_surface._fields_ = [
    ("volume", POINTER(cw_volume)),
    ("isovalue", c_double),
    ("inside_is_low", c_bool),
    ("on_software", c_bool),
]


class cw_sampling(Structure):
    step_vox: float
    cell_steps: bool
    no_preintegration: bool
    jitter: bool
    exact_filter: bool
    no_skipping: bool
    stop_opacity: float
    lean: bool
    texture_edge: int


cw_sampling._fields_ = [
    ("step_vox", c_double),
    ("cell_steps", c_bool),
    ("no_preintegration", c_bool),
    ("jitter", c_bool),
    ("exact_filter", c_bool),
    ("no_skipping", c_bool),
    ("stop_opacity", c_float),
    ("lean", c_bool),
    ("texture_edge", c_size_t),
]


class cw_intensity_look(Structure):
    threshold: float
    minip_inside: bool


cw_intensity_look._fields_ = [
    ("threshold", c_double),
    ("minip_inside", c_bool),
]


class cw_texture_look(Structure):
    target: int
    colors_first: bool
    normals: int
    direction_filter: int
    material_table: bool
    mark_boundary: bool


cw_texture_look._fields_ = [
    ("target", c_int),
    ("colors_first", c_bool),
    ("normals", c_size_t),
    ("direction_filter", c_int),
    ("material_table", c_bool),
    ("mark_boundary", c_bool),
]


class cw_vbuffer_look(Structure):
    pixel_area: bool


cw_vbuffer_look._fields_ = [
    ("pixel_area", c_bool),
]


class cw_projection_look(Structure):
    linear_opacity: bool
    tree_error: float


cw_projection_look._fields_ = [
    ("linear_opacity", c_bool),
    ("tree_error", c_double),
]


class cw_splat_look(Structure):
    kernel: int
    width: float
    tree_error: float
    budget: int


cw_splat_look._fields_ = [
    ("kernel", c_int),
    ("width", c_double),
    ("tree_error", c_double),
    ("budget", c_size_t),
]


class cw_mesh_look(Structure):
    color: Any
    tint: int
    tint_low: float
    tint_high: float
    wireframe: bool
    same_inside: bool
    cap: bool
    live: Any


cw_mesh_look._fields_ = [
    ("color", c_float * 4),
    ("tint", c_int),
    ("tint_low", c_double),
    ("tint_high", c_double),
    ("wireframe", c_bool),
    ("same_inside", c_bool),
    ("cap", c_bool),
    ("live", POINTER(cw_live_surface)),
]


class cw_scene(Structure):
    mode: int
    volume: Any
    mesh: Any
    transfer: Any
    camera: Any
    width: int
    height: int
    samples: int
    reference_of: int
    lights: Any
    light_count: int
    material: Any
    gradient_sigma: float
    lit: bool
    one_sided: bool
    shadow: int
    depth_cue: float
    cue_range: Any
    cue_form: int
    background: Any
    clips: Any
    clip_count: int
    cut_away: bool
    sampling: Any
    intensity: Any
    texture: Any
    vbuffer: Any
    projection: Any
    splat: Any
    mesh_look: Any
    slices: Any
    slice_count: int
    threads: int
    progress: Any


cw_scene._fields_ = [
    ("mode", c_int),
    ("volume", POINTER(cw_volume)),
    ("mesh", POINTER(cw_mesh)),
    ("transfer", POINTER(cw_transfer)),
    ("camera", cw_camera),
    ("width", c_size_t),
    ("height", c_size_t),
    ("samples", c_int),
    ("reference_of", c_int),
    ("lights", cw_light * 4),
    ("light_count", c_size_t),
    ("material", cw_material),
    ("gradient_sigma", c_double),
    ("lit", c_bool),
    ("one_sided", c_bool),
    ("shadow", c_int),
    ("depth_cue", c_float),
    ("cue_range", c_double * 2),
    ("cue_form", c_int),
    ("background", (c_float * 3) * 2),
    ("clips", cw_clip * 12),
    ("clip_count", c_size_t),
    ("cut_away", c_bool),
    ("sampling", cw_sampling),
    ("intensity", cw_intensity_look),
    ("texture", cw_texture_look),
    ("vbuffer", cw_vbuffer_look),
    ("projection", cw_projection_look),
    ("splat", cw_splat_look),
    ("mesh_look", cw_mesh_look),
    ("slices", cw_clip * 4),
    ("slice_count", c_size_t),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_renderer(Structure):
    pass


class cw_picked(Structure):
    kind: int
    point: Any
    depth_mm: float
    value: float
    number: int


cw_picked._fields_ = [
    ("kind", c_int),
    ("point", c_double * 3),
    ("depth_mm", c_double),
    ("value", c_double),
    ("number", c_size_t),
]


class cw_render_mesh_desc(Structure):
    version: int
    camera: Any
    width: int
    height: int
    samples: int
    color: Any
    background: Any
    depth_mm: Any
    same_inside: bool
    threads: int
    progress: Any


cw_render_mesh_desc._fields_ = [
    ("version", c_uint32),
    ("camera", cw_camera),
    ("width", c_size_t),
    ("height", c_size_t),
    ("samples", c_int),
    ("color", c_uint8 * 4),
    ("background", (c_uint8 * 4) * 2),
    ("depth_mm", POINTER(c_double)),
    ("same_inside", c_bool),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_legend_item(Structure):
    name: bytes | None
    color: Any


cw_legend_item._fields_ = [
    ("name", c_char_p),
    ("color", c_uint8 * 3),
]


class cw_value_slices(Structure):
    values: Any
    map: int
    low: float
    high: float
    opacity: float


cw_value_slices._fields_ = [
    ("values", POINTER(cw_volume)),
    ("map", c_int),
    ("low", c_double),
    ("high", c_double),
    ("opacity", c_float),
]


class cw_overlay(Structure):
    axes: bool
    scale_bar: bool
    letters: bool
    color_bar: bool
    histogram: bool
    legend: Any
    legend_count: int
    caption: bytes | None
    statistics: Any
    text_px: float
    color: Any
    isoline: bool
    isovalue: float
    isoline_color: Any
    values_bar: Any


cw_overlay._fields_ = [
    ("axes", c_bool),
    ("scale_bar", c_bool),
    ("letters", c_bool),
    ("color_bar", c_bool),
    ("histogram", c_bool),
    ("legend", POINTER(cw_legend_item)),
    ("legend_count", c_size_t),
    ("caption", c_char_p),
    ("statistics", POINTER(cw_statistics)),
    ("text_px", c_double),
    ("color", c_uint8 * 4),
    ("isoline", c_bool),
    ("isovalue", c_double),
    ("isoline_color", c_uint8 * 4),
    ("values_bar", POINTER(cw_value_slices)),
]


class cw_label_slices(Structure):
    labels: Any
    table: Any
    layer: int
    opacity: float


cw_label_slices._fields_ = [
    ("labels", POINTER(cw_volume)),
    ("table", POINTER(cw_label_table)),
    ("layer", c_uint32),
    ("opacity", c_float),
]


class cw_world_mark(Structure):
    points: Any
    count: int
    is_closed: bool
    text: bytes | None
    text_point: int
    opacity: float


cw_world_mark._fields_ = [
    ("points", POINTER(c_double * 3)),
    ("count", c_size_t),
    ("is_closed", c_bool),
    ("text", c_char_p),
    ("text_point", c_size_t),
    ("opacity", c_float),
]


class cw_pieces_desc(Structure):
    version: int
    pegs: int
    dowels: bool
    peg_diameter_mm: float
    peg_length_mm: float
    clearance_mm: float
    wall_mm: float
    max_automatic_mm: float
    threads: int
    progress: Any


cw_pieces_desc._fields_ = [
    ("version", c_uint32),
    ("pegs", c_size_t),
    ("dowels", c_bool),
    ("peg_diameter_mm", c_double),
    ("peg_length_mm", c_double),
    ("clearance_mm", c_double),
    ("wall_mm", c_double),
    ("max_automatic_mm", c_double),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_piece(Structure):
    mesh: Any
    name: Any
    is_dowel: bool
    volume_mm3: float
    pegs: int
    holes: int
    placed: Any
    plate: int
    foot_mm2: float


cw_piece._fields_ = [
    ("mesh", cw_mesh),
    ("name", c_char * 32),
    ("is_dowel", c_bool),
    ("volume_mm3", c_double),
    ("pegs", c_size_t),
    ("holes", c_size_t),
    ("placed", c_double * 12),
    ("plate", c_size_t),
    ("foot_mm2", c_double),
]


class cw_piece_section(Structure):
    plane: int
    below: int
    above: int
    area_mm2: float
    regions: int
    pegs: int
    widest_mm: float


cw_piece_section._fields_ = [
    ("plane", c_size_t),
    ("below", c_size_t),
    ("above", c_size_t),
    ("area_mm2", c_double),
    ("regions", c_size_t),
    ("pegs", c_size_t),
    ("widest_mm", c_double),
]


class cw_peg(Structure):
    section: int
    center: Any
    direction: Any
    diameter_mm: float
    length_mm: float


cw_peg._fields_ = [
    ("section", c_size_t),
    ("center", c_double * 3),
    ("direction", c_double * 3),
    ("diameter_mm", c_double),
    ("length_mm", c_double),
]


class cw_pieces(Structure):
    version: int
    count: int
    pieces: Any
    section_count: int
    sections: Any
    peg_count: int
    pegs: Any
    settings: Any
    whole_mm3: float
    pieces_mm3: float
    gaps_mm3: float
    shortened: int
    missing: int


cw_pieces._fields_ = [
    ("version", c_uint32),
    ("count", c_size_t),
    ("pieces", POINTER(cw_piece)),
    ("section_count", c_size_t),
    ("sections", POINTER(cw_piece_section)),
    ("peg_count", c_size_t),
    ("pegs", POINTER(cw_peg)),
    ("settings", cw_pieces_desc),
    ("whole_mm3", c_double),
    ("pieces_mm3", c_double),
    ("gaps_mm3", c_double),
    ("shortened", c_size_t),
    ("missing", c_size_t),
]


class cw_plate_desc(Structure):
    version: int
    plate_mm: Any
    reserve_mm: float


cw_plate_desc._fields_ = [
    ("version", c_uint32),
    ("plate_mm", c_double * 3),
    ("reserve_mm", c_double),
]


class cw_lay_desc(Structure):
    version: int
    plate_mm: Any
    gap_mm: float


cw_lay_desc._fields_ = [
    ("version", c_uint32),
    ("plate_mm", c_double * 3),
    ("gap_mm", c_double),
]


class cw_assembled(Structure):
    version: int
    whole_mm3: float
    assembled_mm3: float
    overlap_mm3: float
    missing_mm3: float
    beyond_mm3: float
    farthest_mm: float
    lines: int


cw_assembled._fields_ = [
    ("version", c_uint32),
    ("whole_mm3", c_double),
    ("assembled_mm3", c_double),
    ("overlap_mm3", c_double),
    ("missing_mm3", c_double),
    ("beyond_mm3", c_double),
    ("farthest_mm", c_double),
    ("lines", c_size_t),
]


class cw_simplify_view(Structure):
    camera: Any
    width: int
    height: int
    depth: Any


cw_simplify_view._fields_ = [
    ("camera", cw_camera),
    ("width", c_size_t),
    ("height", c_size_t),
    ("depth", POINTER(c_float)),
]


class cw_simplify_desc(Structure):
    version: int
    error_mm: float
    views: Any
    view_count: int
    pixel_error: float
    normal_deg: float
    triangles: int
    ratio: float
    allow_crossings: bool
    keep_border: bool
    normal_weight: float
    color_weight: float
    scalar_weight: float
    threads: int
    progress: Any


cw_simplify_desc._fields_ = [
    ("version", c_uint32),
    ("error_mm", c_double),
    ("views", POINTER(cw_simplify_view)),
    ("view_count", c_size_t),
    ("pixel_error", c_double),
    ("normal_deg", c_double),
    ("triangles", c_size_t),
    ("ratio", c_double),
    ("allow_crossings", c_bool),
    ("keep_border", c_bool),
    ("normal_weight", c_float),
    ("color_weight", c_float),
    ("scalar_weight", c_float),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_simplify_facts(Structure):
    vertices: int
    triangles: int
    cut: int
    passes: int


cw_simplify_facts._fields_ = [
    ("vertices", c_size_t),
    ("triangles", c_size_t),
    ("cut", c_size_t),
    ("passes", c_size_t),
]


class cw_simplifier(Structure):
    pass


class cw_smooth_desc(Structure):
    version: int
    iterations: int
    max_move_mm: float
    move_border: bool
    allow_crossings: bool
    threads: int
    progress: Any
    method: int
    width_mm: float


cw_smooth_desc._fields_ = [
    ("version", c_uint32),
    ("iterations", c_size_t),
    ("max_move_mm", c_double),
    ("move_border", c_bool),
    ("allow_crossings", c_bool),
    ("threads", c_int),
    ("progress", cw_progress),
    ("method", c_int),
    ("width_mm", c_double),
]


class cw_smooth_facts(Structure):
    limit_mm: float
    width_mm: float
    iterations: int
    max_mm: float
    mean_mm: float
    volume_before_mm3: float
    volume_after_mm3: float
    flipped: int
    border: int
    junction: int
    put_back: int
    undecided: bool


cw_smooth_facts._fields_ = [
    ("limit_mm", c_double),
    ("width_mm", c_double),
    ("iterations", c_size_t),
    ("max_mm", c_double),
    ("mean_mm", c_double),
    ("volume_before_mm3", c_double),
    ("volume_after_mm3", c_double),
    ("flipped", c_size_t),
    ("border", c_size_t),
    ("junction", c_size_t),
    ("put_back", c_size_t),
    ("undecided", c_bool),
]


class cw_pipeline_color(Structure):
    open: Any
    user: Any
    map: int
    has_range: bool
    low: float
    high: float


cw_pipeline_color._fields_ = [
    ("open", CFUNCTYPE(c_int, c_void_p, POINTER(POINTER(cw_volume)), POINTER(cw_error))),
    ("user", c_void_p),
    ("map", c_int),
    ("has_range", c_bool),
    ("low", c_double),
    ("high", c_double),
]


class cw_pipeline_watch(Structure):
    begin: Any
    end: Any
    user: Any


cw_pipeline_watch._fields_ = [
    ("begin", CFUNCTYPE(cw_progress, c_void_p, c_int, c_size_t, c_char_p)),
    ("end", CFUNCTYPE(None, c_void_p, c_int, c_size_t, c_size_t)),
    ("user", c_void_p),
]


class cw_pipeline_desc(Structure):
    version: int
    extract: Any
    min_volume_mm3: float
    largest: int
    fill_voids: bool
    smooth: Any
    cut: Any
    simplify: Any
    views: Any
    view_count: int
    cull: bool
    lod: Any
    lod_count: int
    color: Any
    check: bool
    layers: int
    spool_path: bytes | None
    watch: Any
    close_handles: Any
    atlas: Any
    bake: Any
    crease_degrees: float
    crease_caps: bool
    engrave: Any


cw_pipeline_desc._fields_ = [
    ("version", c_uint32),
    ("extract", cw_extract_desc),
    ("min_volume_mm3", c_double),
    ("largest", c_size_t),
    ("fill_voids", c_bool),
    ("smooth", POINTER(cw_smooth_desc)),
    ("cut", POINTER(cw_cut_desc)),
    ("simplify", POINTER(cw_simplify_desc)),
    ("views", POINTER(cw_simplify_view)),
    ("view_count", c_size_t),
    ("cull", c_bool),
    ("lod", POINTER(c_size_t)),
    ("lod_count", c_size_t),
    ("color", POINTER(cw_pipeline_color)),
    ("check", c_bool),
    ("layers", c_size_t),
    ("spool_path", c_char_p),
    ("watch", cw_pipeline_watch),
    ("close_handles", POINTER(cw_close_handles_desc)),
    ("atlas", POINTER(cw_atlas_desc)),
    ("bake", POINTER(cw_bake_desc)),
    ("crease_degrees", c_double),
    ("crease_caps", c_bool),
    ("engrave", POINTER(cw_engrave_desc)),
]


class cw_pipeline_facts(Structure):
    version: int
    ran: int
    extracted: Any
    small: Any
    others: Any
    voids: Any
    smoothed: Any
    cut: Any
    culled: int
    voxels: int
    seen_voxels: int
    color: Any
    color_low: float
    color_high: float
    quality: Any
    handles: Any
    atlas: Any
    baked: Any
    creases: int
    engraved: Any


cw_pipeline_facts._fields_ = [
    ("version", c_uint32),
    ("ran", c_uint),
    ("extracted", cw_extract_counts),
    ("small", cw_drop_counts),
    ("others", cw_drop_counts),
    ("voids", cw_drop_counts),
    ("smoothed", cw_smooth_facts),
    ("cut", cw_cut_facts),
    ("culled", c_size_t),
    ("voxels", c_size_t),
    ("seen_voxels", c_size_t),
    ("color", cw_sample_facts),
    ("color_low", c_double),
    ("color_high", c_double),
    ("quality", cw_quality),
    ("handles", cw_close_handles_facts),
    ("atlas", cw_atlas_facts),
    ("baked", cw_bake_facts),
    ("creases", c_size_t),
    ("engraved", cw_engrave_facts),
]


class cw_pipeline_surface(Structure):
    mesh: Any
    spool: Any
    level: int
    layer: int
    label: int
    full: Any
    maps: Any


cw_pipeline_surface._fields_ = [
    ("mesh", POINTER(cw_mesh)),
    ("spool", POINTER(cw_mesh_spool)),
    ("level", c_size_t),
    ("layer", c_size_t),
    ("label", c_uint32),
    ("full", POINTER(cw_mesh)),
    ("maps", POINTER(cw_image)),
]


class cw_pipeline_sink(Structure):
    take: Any
    user: Any


cw_pipeline_sink._fields_ = [
    ("take", CFUNCTYPE(c_int, c_void_p, POINTER(cw_pipeline_surface), POINTER(cw_pipeline_facts), POINTER(cw_error))),
    ("user", c_void_p),
]


class cw_pipeline_labels(Structure):
    layers: Any
    layer_count: int
    apart: bool
    interfaces_only: bool
    wants: Any
    user: Any


cw_pipeline_labels._fields_ = [
    ("layers", POINTER(POINTER(cw_label_surfaces))),
    ("layer_count", c_size_t),
    ("apart", c_bool),
    ("interfaces_only", c_bool),
    ("wants", CFUNCTYPE(c_bool, c_void_p, c_size_t, c_uint32)),
    ("user", c_void_p),
]


class cw_remesh_desc(Structure):
    version: int
    edge_mm: float
    shortest_mm: float
    error_mm: float
    feature_deg: float
    min_angle_deg: float
    iterations: int
    threads: int
    progress: Any
    is_adaptive: bool


cw_remesh_desc._fields_ = [
    ("version", c_uint32),
    ("edge_mm", c_double),
    ("shortest_mm", c_double),
    ("error_mm", c_double),
    ("feature_deg", c_double),
    ("min_angle_deg", c_double),
    ("iterations", c_size_t),
    ("threads", c_int),
    ("progress", cw_progress),
    ("is_adaptive", c_bool),
]


class cw_remesh_facts(Structure):
    edge_mm: float
    shortest_mm: float
    error_mm: float
    feature_deg: float
    min_angle_deg: float
    iterations: int
    triangles_before: int
    triangles_after: int
    min_edge_mm: float
    mean_edge_mm: float
    max_edge_mm: float
    fitting_edges: float
    smallest_deg: float
    where: Any
    below: int
    features_before: int
    features_after: int
    border_before: int
    border_after: int
    crossings_before: int
    crossings_after: int
    beyond: int
    attempts: int
    is_undecided: bool


cw_remesh_facts._fields_ = [
    ("edge_mm", c_double),
    ("shortest_mm", c_double),
    ("error_mm", c_double),
    ("feature_deg", c_double),
    ("min_angle_deg", c_double),
    ("iterations", c_size_t),
    ("triangles_before", c_size_t),
    ("triangles_after", c_size_t),
    ("min_edge_mm", c_double),
    ("mean_edge_mm", c_double),
    ("max_edge_mm", c_double),
    ("fitting_edges", c_double),
    ("smallest_deg", c_double),
    ("where", c_double * 3),
    ("below", c_size_t),
    ("features_before", c_size_t),
    ("features_after", c_size_t),
    ("border_before", c_size_t),
    ("border_after", c_size_t),
    ("crossings_before", c_size_t),
    ("crossings_after", c_size_t),
    ("beyond", c_size_t),
    ("attempts", c_size_t),
    ("is_undecided", c_bool),
]


class cw_repair_desc(Structure):
    version: int
    weld_mm: float
    max_hole_mm: float
    wrap_mm: float
    max_move_mm: float
    flat_holes: bool
    keep_crossings: bool
    keep_cracks: bool
    outer_only: bool
    threads: int
    progress: Any


cw_repair_desc._fields_ = [
    ("version", c_uint32),
    ("weld_mm", c_double),
    ("max_hole_mm", c_double),
    ("wrap_mm", c_double),
    ("max_move_mm", c_double),
    ("flat_holes", c_bool),
    ("keep_crossings", c_bool),
    ("keep_cracks", c_bool),
    ("outer_only", c_bool),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_repair_facts(Structure):
    welded: int
    split_edges: int
    weld_mm: float
    duplicates: int
    degenerate: int
    flipped_triangles: int
    flipped_shells: int
    nonmanifold_edges: int
    twisted_edges: int
    one_sided: int
    nonmanifold_vertices: int
    parted_mm: float
    sheets: int
    sheet_triangles: int
    holes_filled: int
    holes_left: int
    largest_hole_mm: float
    largest_rim_mm: float
    largest_fill_mm2: float
    added_triangles: int
    crossings_before: int
    crossings_after: int
    touching_vertices: int
    united_shells: int
    removed_triangles: int
    inner_shells: int
    inner_mm3: float
    is_wrapped: bool
    is_union_lacking: bool
    is_undecided: bool
    volume_before_mm3: float
    volume_after_mm3: float
    volume_changed: float
    moved_mm: float
    beyond_mm: float
    max_move_mm: float
    changes_volume: bool
    moves_far: bool
    is_refused: bool
    is_needed: bool
    is_sound: bool


cw_repair_facts._fields_ = [
    ("welded", c_size_t),
    ("split_edges", c_size_t),
    ("weld_mm", c_double),
    ("duplicates", c_size_t),
    ("degenerate", c_size_t),
    ("flipped_triangles", c_size_t),
    ("flipped_shells", c_size_t),
    ("nonmanifold_edges", c_size_t),
    ("twisted_edges", c_size_t),
    ("one_sided", c_size_t),
    ("nonmanifold_vertices", c_size_t),
    ("parted_mm", c_double),
    ("sheets", c_size_t),
    ("sheet_triangles", c_size_t),
    ("holes_filled", c_size_t),
    ("holes_left", c_size_t),
    ("largest_hole_mm", c_double),
    ("largest_rim_mm", c_double),
    ("largest_fill_mm2", c_double),
    ("added_triangles", c_size_t),
    ("crossings_before", c_size_t),
    ("crossings_after", c_size_t),
    ("touching_vertices", c_size_t),
    ("united_shells", c_size_t),
    ("removed_triangles", c_size_t),
    ("inner_shells", c_size_t),
    ("inner_mm3", c_double),
    ("is_wrapped", c_bool),
    ("is_union_lacking", c_bool),
    ("is_undecided", c_bool),
    ("volume_before_mm3", c_double),
    ("volume_after_mm3", c_double),
    ("volume_changed", c_double),
    ("moved_mm", c_double),
    ("beyond_mm", c_double),
    ("max_move_mm", c_double),
    ("changes_volume", c_bool),
    ("moves_far", c_bool),
    ("is_refused", c_bool),
    ("is_needed", c_bool),
    ("is_sound", c_bool),
]


class cw_slice_filter_desc(Structure):
    version: int
    kind: int
    sigma_voxels: Any
    radius: int
    slices: int
    threads: int


cw_slice_filter_desc._fields_ = [
    ("version", c_uint32),
    ("kind", c_int),
    ("sigma_voxels", c_double * 3),
    ("radius", c_size_t),
    ("slices", c_size_t),
    ("threads", c_int),
]


class cw_slice_filter(Structure):
    pass


class cw_voxelize_part(Structure):
    volume_mm3: float
    filled_mm3: float
    voxels: int
    overlapped: int
    repeated: int
    negative: int
    solids: int
    lost: int
    thin_places: int
    thin_mm2: float
    area_mm2: float
    outside_mm2: float
    turned: bool
    open: bool


cw_voxelize_part._fields_ = [
    ("volume_mm3", c_double),
    ("filled_mm3", c_double),
    ("voxels", c_size_t),
    ("overlapped", c_size_t),
    ("repeated", c_size_t),
    ("negative", c_size_t),
    ("solids", c_size_t),
    ("lost", c_size_t),
    ("thin_places", c_size_t),
    ("thin_mm2", c_double),
    ("area_mm2", c_double),
    ("outside_mm2", c_double),
    ("turned", c_bool),
    ("open", c_bool),
]


class cw_voxelize_desc(Structure):
    version: int
    like: Any
    spacing_mm: Any
    low: Any
    high: Any
    labels: Any
    partial: bool
    max_bytes: int
    parts: Any
    threads: int
    progress: Any


cw_voxelize_desc._fields_ = [
    ("version", c_uint32),
    ("like", POINTER(cw_volume)),
    ("spacing_mm", c_double * 3),
    ("low", c_double * 3),
    ("high", c_double * 3),
    ("labels", POINTER(c_uint32)),
    ("partial", c_bool),
    ("max_bytes", c_size_t),
    ("parts", POINTER(cw_voxelize_part)),
    ("threads", c_int),
    ("progress", cw_progress),
]


class cw_within(Structure):
    mesh: Any
    volume_mm3: float
    mean: float
    sd: float
    min: float
    max: float
    voxels: int
    halves: int


cw_within._fields_ = [
    ("mesh", cw_voxelize_part),
    ("volume_mm3", c_double),
    ("mean", c_double),
    ("sd", c_double),
    ("min", c_double),
    ("max", c_double),
    ("voxels", c_size_t),
    ("halves", c_size_t),
]


cw_slice = cw_clip

# The result and the arguments of each function.
FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "cw_version": (c_char_p, []),
    "cw_memory_limit": (None, [c_size_t]),
    "cw_memory_used": (c_size_t, []),
    "cw_memory_overflow": (c_int, [POINTER(cw_overflow_desc), POINTER(cw_error)]),
    "cw_memory_overflowed": (c_size_t, []),
    "cw_allocator_set": (c_int, [POINTER(cw_allocator), POINTER(cw_error)]),
    "cw_status_exit_code": (c_int, [c_int]),
    "cw_status_name": (c_char_p, [c_int]),
    "cw_status_text": (c_char_p, [c_int]),
    "cw_features": (POINTER(cw_feature), [POINTER(c_size_t)]),
    "cw_view_name": (c_char_p, [c_size_t]),
    "cw_camera_fit": (c_int, [POINTER(cw_fit_desc), POINTER(cw_camera), POINTER(cw_error)]),
    "cw_camera_axes": (c_int, [POINTER(cw_camera), POINTER(c_double), POINTER(c_double), POINTER(c_double), POINTER(cw_error)]),
    "cw_camera_turn": (c_int, [POINTER(cw_camera), POINTER(c_double), c_double, POINTER(cw_error)]),
    "cw_camera_zoom": (c_int, [POINTER(cw_camera), c_double, POINTER(cw_error)]),
    "cw_camera_dolly": (c_int, [POINTER(cw_camera), c_double, POINTER(cw_error)]),
    "cw_camera_orbit": (c_int, [POINTER(cw_camera), c_double, c_double, POINTER(cw_error)]),
    "cw_camera_roll": (c_int, [POINTER(cw_camera), c_double, POINTER(cw_error)]),
    "cw_camera_pan": (c_int, [POINTER(cw_camera), c_size_t, c_double, c_double, POINTER(cw_error)]),
    "cw_camera_project": (c_bool, [POINTER(cw_camera), c_size_t, c_size_t, POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    "cw_camera_ray": (c_int, [POINTER(cw_camera), c_size_t, c_size_t, POINTER(c_double), POINTER(c_double), POINTER(c_double), POINTER(cw_error)]),
    "cw_camera_path": (c_int, [POINTER(cw_camera), POINTER(c_double), c_size_t, c_double, POINTER(cw_camera), POINTER(cw_error)]),
    "cw_camera_read": (c_int, [c_char_p, POINTER(cw_camera), POINTER(cw_error)]),
    "cw_camera_write": (c_int, [c_char_p, POINTER(cw_camera), POINTER(cw_error)]),
    "cw_camera_parse": (c_int, [c_char_p, POINTER(cw_camera), POINTER(cw_error)]),
    "cw_camera_format": (c_int, [POINTER(cw_camera), POINTER(c_char), POINTER(cw_error)]),
    "cw_type_size": (c_size_t, [c_int]),
    "cw_type_name": (c_char_p, [c_int]),
    "cw_volume_alloc": (c_int, [POINTER(cw_volume), c_int, POINTER(c_size_t), c_size_t, c_size_t, POINTER(cw_error)]),
    "cw_volume_free": (None, [POINTER(cw_volume)]),
    "cw_volume_voxels": (c_void_p, [POINTER(cw_volume)]),
    "cw_volume_resolve": (c_int, [POINTER(cw_volume), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_select": (c_int, [POINTER(cw_volume), c_size_t, c_size_t, POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_magnitude": (c_int, [POINTER(cw_volume), c_size_t, c_int, POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_labels": (c_int, [POINTER(cw_volume), POINTER(cw_labels), POINTER(cw_error)]),
    "cw_volume_crop": (c_int, [POINTER(cw_volume), POINTER(cw_box), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_coarsen": (c_int, [POINTER(cw_volume), POINTER(c_size_t), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_densify": (c_int, [POINTER(cw_volume), c_size_t, POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_value": (c_double, [POINTER(cw_volume), c_size_t, c_size_t, c_size_t]),
    "cw_volume_to_world": (None, [POINTER(cw_volume), POINTER(c_double), POINTER(c_double)]),
    "cw_volume_spacing": (None, [POINTER(cw_volume), POINTER(c_double)]),
    "cw_volume_corners": (None, [POINTER(cw_volume), POINTER(c_double * 3)]),
    "cw_volume_to_index": (c_int, [POINTER(cw_volume), POINTER(c_double), POINTER(c_double), POINTER(cw_error)]),
    "cw_volume_sample": (c_double, [POINTER(cw_volume), POINTER(c_double)]),
    "cw_volume_statistics": (c_int, [POINTER(cw_volume), c_size_t, c_int, POINTER(cw_statistics), POINTER(cw_error)]),
    "cw_statistics_free": (None, [POINTER(cw_statistics)]),
    "cw_statistics_join": (c_int, [POINTER(cw_statistics), c_size_t, c_size_t, POINTER(cw_statistics), POINTER(cw_error)]),
    "cw_statistics_otsu": (c_bool, [POINTER(cw_statistics), c_int, POINTER(c_double)]),
    "cw_volume_level": (c_int, [POINTER(cw_volume), c_char_p, c_int, POINTER(c_double), POINTER(cw_error)]),
    "cw_statistics_level": (c_int, [POINTER(cw_statistics), POINTER(cw_volume), c_char_p, POINTER(c_double), POINTER(cw_error)]),
    "cw_mesh_free": (None, [POINTER(cw_mesh)]),
    "cw_mesh_attribute_add": (c_int, [POINTER(cw_mesh), POINTER(cw_attribute), POINTER(POINTER(cw_attribute)), POINTER(cw_error)]),
    "cw_mesh_attribute_find": (POINTER(cw_attribute), [POINTER(cw_mesh), c_char_p]),
    "cw_mesh_attribute_remove": (None, [POINTER(cw_mesh), c_char_p]),
    "cw_mesh_check": (c_int, [POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_mesh_bounds": (c_bool, [POINTER(cw_mesh), POINTER(c_double), POINTER(c_double)]),
    "cw_mesh_normals": (c_int, [POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_mesh_crease_normals": (c_int, [POINTER(cw_mesh), c_double, POINTER(c_uint8), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_mesh_transform": (c_int, [POINTER(cw_mesh), POINTER(c_double), POINTER(cw_error)]),
    "cw_mesh_split": (c_int, [POINTER(cw_mesh), POINTER(POINTER(cw_mesh)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_meshes_free": (None, [POINTER(cw_mesh), c_size_t]),
    "cw_mesh_weld": (c_int, [POINTER(cw_mesh), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_mesh_drop_components": (c_int, [POINTER(cw_mesh), c_double, POINTER(c_size_t), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_mesh_drop_volumes": (c_int, [POINTER(cw_mesh), c_double, POINTER(cw_drop_counts), POINTER(cw_error)]),
    "cw_mesh_keep_largest": (c_int, [POINTER(cw_mesh), c_size_t, POINTER(cw_drop_counts), POINTER(cw_error)]),
    "cw_mesh_drop_distant": (c_int, [POINTER(cw_mesh), POINTER(c_float), c_double, POINTER(cw_drop_counts), POINTER(c_double), POINTER(cw_error)]),
    "cw_picture_alloc": (c_int, [POINTER(cw_picture), c_size_t, c_size_t, POINTER(cw_error)]),
    "cw_picture_free": (None, [POINTER(cw_picture)]),
    "cw_image_alloc": (c_int, [POINTER(cw_image), c_size_t, c_size_t, POINTER(cw_error)]),
    "cw_image_free": (None, [POINTER(cw_image)]),
    "cw_picture_show": (c_int, [POINTER(cw_picture), POINTER(c_uint8 * 4), POINTER(cw_image), POINTER(cw_error)]),
    "cw_picture_compare": (c_int, [POINTER(cw_picture), POINTER(cw_picture), POINTER(c_float * 3), POINTER(cw_comparison), POINTER(cw_error)]),
    "cw_picture_difference": (c_int, [POINTER(cw_picture), POINTER(cw_picture), c_double, POINTER(cw_picture), POINTER(cw_error)]),
    "cw_picture_split": (c_int, [POINTER(cw_picture), POINTER(cw_picture), c_double, POINTER(cw_picture), POINTER(cw_error)]),
    "cw_image_compare": (c_int, [POINTER(cw_image), POINTER(cw_image), c_int, POINTER(c_size_t), POINTER(cw_error)]),
    "cw_image_write": (c_int, [c_char_p, POINTER(cw_image), POINTER(cw_error)]),
    "cw_image_encode": (c_int, [POINTER(cw_image), c_bool, POINTER(POINTER(c_uint8)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_image_decode": (c_int, [POINTER(c_uint8), c_size_t, POINTER(cw_image), POINTER(cw_error)]),
    "cw_bytes_free": (None, [POINTER(c_uint8)]),
    "cw_appearance_measure": (c_int, [POINTER(cw_surface_look), c_size_t, POINTER(cw_surface_look), c_size_t, POINTER(cw_appearance_desc), POINTER(cw_appearance), POINTER(cw_appearance), POINTER(cw_error)]),
    "cw_appearance_find_view": (c_int, [POINTER(cw_surface_look), c_size_t, c_uint32, c_uint32, POINTER(cw_appearance_view), POINTER(cw_error)]),
    "cw_appearance_draw": (c_int, [POINTER(cw_surface_look), c_size_t, POINTER(cw_camera), POINTER(cw_appearance_desc), POINTER(cw_image), POINTER(cw_error)]),
    "cw_mesh_atlas": (c_int, [POINTER(cw_mesh), POINTER(cw_atlas_desc), POINTER(cw_atlas_facts), POINTER(cw_error)]),
    "cw_meshes_atlas": (c_int, [POINTER(POINTER(cw_mesh)), POINTER(c_double), c_size_t, POINTER(cw_atlas_desc), POINTER(cw_atlas_facts), POINTER(cw_error)]),
    "cw_mesh_split_seams": (c_int, [POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_mesh_texture_distance": (c_int, [POINTER(cw_mesh), POINTER(cw_mesh), c_int, POINTER(cw_texture_distance), POINTER(cw_error)]),
    "cw_map_name": (c_char_p, [c_int]),
    "cw_bake_normals": (c_int, [POINTER(cw_mesh), POINTER(cw_mesh), POINTER(cw_bake_desc), POINTER(cw_image), POINTER(cw_bake_facts), POINTER(cw_error)]),
    "cw_bake_maps": (c_int, [POINTER(cw_mesh), POINTER(cw_mesh), POINTER(cw_bake_desc), POINTER(cw_image), POINTER(cw_bake_facts), POINTER(cw_error)]),
    "cw_bake_meshes": (c_int, [POINTER(POINTER(cw_mesh)), c_size_t, POINTER(cw_mesh), POINTER(cw_bake_desc), POINTER(cw_image), POINTER(cw_bake_facts), POINTER(cw_error)]),
    "cw_bake_pictures": (c_int, [POINTER(cw_mesh), POINTER(cw_bake_source), c_size_t, POINTER(cw_bake_desc), POINTER(cw_image), POINTER(cw_bake_facts), POINTER(cw_error)]),
    "cw_mesh_boolean": (c_int, [POINTER(POINTER(cw_mesh)), c_size_t, POINTER(cw_boolean_desc), POINTER(cw_mesh), POINTER(cw_boolean_facts), POINTER(cw_error)]),
    "cw_distance_to_field": (c_int, [POINTER(cw_mesh), POINTER(cw_volume), POINTER(cw_field_distance_desc), POINTER(cw_distance), POINTER(c_float), POINTER(cw_error)]),
    "cw_distance_to_mesh": (c_int, [POINTER(cw_mesh), POINTER(cw_mesh), POINTER(cw_mesh_distance_desc), POINTER(cw_distance), POINTER(c_float), POINTER(cw_error)]),
    "cw_mesh_compare": (c_int, [POINTER(cw_mesh), POINTER(cw_mesh), POINTER(cw_mesh_distance_desc), POINTER(cw_mesh_comparison), POINTER(cw_error)]),
    "cw_mesh_comparison_rms": (c_double, [POINTER(cw_mesh_comparison)]),
    "cw_mesh_comparison_max": (c_double, [POINTER(cw_mesh_comparison)]),
    "cw_print_measure": (c_int, [POINTER(cw_mesh), POINTER(cw_print_desc), POINTER(cw_print_facts), POINTER(cw_error)]),
    "cw_orient_print": (c_int, [POINTER(cw_mesh), POINTER(cw_print_desc), POINTER(cw_orient_facts), POINTER(cw_error)]),
    "cw_extract": (c_int, [POINTER(cw_volume), POINTER(cw_extract_desc), POINTER(cw_mesh), POINTER(cw_extract_counts), POINTER(cw_error)]),
    "cw_extract_slabs": (c_int, [POINTER(cw_volume), POINTER(cw_extract_desc), c_size_t, cw_slab_sink, POINTER(cw_extract_counts), POINTER(cw_error)]),
    "cw_extract_predict": (c_int, [POINTER(cw_volume), POINTER(cw_extract_desc), POINTER(cw_extract_counts), POINTER(cw_error)]),
    "cw_extractor_new": (c_int, [POINTER(cw_volume), POINTER(POINTER(cw_extractor)), POINTER(cw_error)]),
    "cw_extractor_free": (None, [POINTER(cw_extractor)]),
    "cw_extractor_update": (c_int, [POINTER(cw_extractor), POINTER(cw_box), POINTER(cw_error)]),
    "cw_extractor_extract": (c_int, [POINTER(cw_extractor), POINTER(cw_extract_desc), POINTER(cw_mesh), POINTER(cw_extract_counts), POINTER(cw_error)]),
    "cw_extractor_predict": (c_int, [POINTER(cw_extractor), POINTER(cw_extract_desc), POINTER(cw_extract_counts), POINTER(cw_error)]),
    "cw_extractor_extract_changed": (c_int, [POINTER(cw_extractor), POINTER(cw_extract_desc), cw_brick_sink, POINTER(cw_error)]),
    "cw_extractor_recycle": (None, [POINTER(cw_extractor), POINTER(cw_mesh)]),
    "cw_extract_normals": (c_int, [POINTER(cw_volume), POINTER(cw_normals_desc), POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_extract_stream": (c_int, [POINTER(cw_slice_source), POINTER(cw_stream_desc), cw_chunk_sink, POINTER(cw_extract_counts), POINTER(cw_error)]),
    "cw_extract_stream_part": (c_int, [POINTER(cw_slice_source), POINTER(cw_stream_desc), c_size_t, c_size_t, cw_chunk_sink, POINTER(cw_part_counts), POINTER(cw_error)]),
    "cw_extract_stream_slabs": (c_int, [POINTER(cw_slice_source), POINTER(cw_stream_desc), c_size_t, cw_slab_sink, POINTER(cw_extract_counts), POINTER(cw_error)]),
    "cw_extract_stream_normals": (c_int, [POINTER(cw_slice_source), POINTER(cw_normals_desc), c_size_t, POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_stream_statistics": (c_int, [POINTER(cw_slice_source), c_size_t, c_int, POINTER(cw_statistics), POINTER(cw_error)]),
    "cw_extract_stream_bytes": (c_size_t, [POINTER(cw_volume), POINTER(cw_stream_desc), c_bool]),
    "cw_quality_measure": (c_int, [POINTER(cw_mesh), POINTER(cw_quality_desc), POINTER(cw_quality), POINTER(cw_error)]),
    "cw_quality_bytes": (c_size_t, [c_size_t, c_size_t]),
    "cw_quality_stream_new": (c_int, [POINTER(cw_quality_stream_desc), POINTER(POINTER(cw_quality_stream)), POINTER(cw_error)]),
    "cw_quality_stream_sink": (cw_chunk_sink, [POINTER(cw_quality_stream)]),
    "cw_quality_stream_finish": (c_int, [POINTER(cw_quality_stream), POINTER(cw_quality), POINTER(cw_error)]),
    "cw_quality_stream_bytes": (c_size_t, [POINTER(cw_quality_stream)]),
    "cw_quality_stream_free": (None, [POINTER(cw_quality_stream)]),
    "cw_mesh_orient": (c_int, [POINTER(cw_mesh), c_int, POINTER(cw_orient_counts), POINTER(cw_error)]),
    "cw_mesh_fill_voids": (c_int, [POINTER(cw_mesh), c_int, POINTER(cw_drop_counts), POINTER(cw_error)]),
    "cw_quality_is_closed_manifold": (c_bool, [POINTER(cw_quality)]),
    "cw_quality_compare": (c_int, [POINTER(cw_quality), POINTER(cw_quality), POINTER(cw_error)]),
    "cw_self_intersections": (c_int, [POINTER(cw_mesh), POINTER(cw_crossings_desc), POINTER(cw_crossings), POINTER(cw_error)]),
    "cw_crossings_free": (None, [POINTER(cw_crossings)]),
    "cw_quality_has_cgal": (c_bool, []),
    "cw_quality_ask_cgal": (c_int, [POINTER(cw_mesh), c_int, POINTER(cw_cgal_facts), POINTER(cw_error)]),
    "cw_distance_by_cgal": (c_int, [POINTER(cw_mesh), POINTER(cw_mesh), c_double, POINTER(c_double), POINTER(cw_error)]),
    "cw_check_budget": (POINTER(cw_budget), [c_int]),
    "cw_check_wants_crossings": (c_bool, [c_int]),
    "cw_check_judge": (c_size_t, [POINTER(cw_findings), c_int, POINTER(cw_verdict)]),
    "cw_check_holds": (c_bool, [POINTER(cw_verdict), c_size_t]),
    "cw_grade_name": (c_char_p, [c_int]),
    "cw_contacts_find": (c_int, [POINTER(cw_mesh), POINTER(c_uint32), POINTER(cw_contacts), POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_check_paints": (POINTER(cw_paint), [POINTER(c_size_t)]),
    "cw_check_paint": (c_int, [POINTER(cw_mesh), POINTER(c_uint8), POINTER(c_float), c_double, POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_colormap_name": (c_char_p, [c_int]),
    "cw_colormap_color": (None, [c_int, c_double, POINTER(c_uint8)]),
    "cw_mesh_sample": (c_int, [POINTER(cw_mesh), POINTER(cw_volume), POINTER(cw_sample_desc), POINTER(cw_sample_facts), POINTER(cw_error)]),
    "cw_mesh_color": (c_int, [POINTER(cw_mesh), c_int, c_double, c_double, POINTER(cw_error)]),
    "cw_mesh_cut": (c_int, [POINTER(cw_mesh), POINTER(cw_cut_desc), POINTER(cw_mesh), POINTER(cw_cut_facts), POINTER(cw_error)]),
    "cw_mesh_engrave": (c_int, [POINTER(cw_mesh), POINTER(cw_engrave_desc), POINTER(cw_mesh), POINTER(cw_engrave_facts), POINTER(cw_error)]),
    "cw_field_name": (c_char_p, [c_int]),
    "cw_field_about": (c_char_p, [c_int]),
    "cw_field_isovalue": (c_double, [c_int]),
    "cw_field_find": (c_bool, [c_char_p, POINTER(c_int)]),
    "cw_field_value": (c_double, [c_int, POINTER(c_double)]),
    "cw_field_stored": (c_double, [c_int, c_int, c_double]),
    "cw_field_sample": (c_int, [POINTER(cw_field_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_label_field_sample": (c_int, [POINTER(cw_label_field_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_field_measure": (c_int, [c_int, c_double, c_double, POINTER(cw_mesh), POINTER(cw_field_error), POINTER(cw_error)]),
    "cw_field_measure_vertices": (c_int, [c_int, c_double, c_double, POINTER(cw_mesh), c_size_t, POINTER(cw_field_vertex_error), POINTER(cw_error)]),
    "cw_kernel_name": (c_char_p, [c_int]),
    "cw_filter_type": (c_int, [POINTER(cw_volume)]),
    "cw_volume_gauss": (c_int, [POINTER(cw_volume), POINTER(c_double), POINTER(cw_filter_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_median": (c_int, [POINTER(cw_volume), c_size_t, POINTER(cw_filter_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_noise": (c_int, [POINTER(cw_volume), c_int, POINTER(c_double), POINTER(cw_error)]),
    "cw_volume_bilateral": (c_int, [POINTER(cw_volume), POINTER(c_double), c_double, POINTER(cw_filter_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_aniso": (c_int, [POINTER(cw_volume), c_size_t, c_double, POINTER(cw_filter_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_nlm": (c_int, [POINTER(cw_volume), c_double, c_size_t, POINTER(cw_filter_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_resample": (c_int, [POINTER(cw_volume), POINTER(c_double), c_int, POINTER(cw_filter_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_mask": (c_int, [POINTER(cw_volume), POINTER(cw_volume), POINTER(cw_inside), POINTER(cw_filter_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_open": (c_int, [POINTER(cw_volume), POINTER(c_double), POINTER(cw_inside), POINTER(cw_filter_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_close": (c_int, [POINTER(cw_volume), POINTER(c_double), POINTER(cw_inside), POINTER(cw_filter_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_inside_box": (c_int, [POINTER(cw_volume), POINTER(cw_inside), c_size_t, c_int, POINTER(cw_box), POINTER(cw_error)]),
    "cw_volume_remove_table": (c_int, [POINTER(cw_volume), POINTER(cw_filter_desc), POINTER(cw_volume), POINTER(c_double), POINTER(cw_error)]),
    "cw_label_table_free": (None, [POINTER(cw_label_table)]),
    "cw_label_find": (POINTER(cw_label), [POINTER(cw_label_table), c_uint32, c_uint32]),
    "cw_label_find_name": (POINTER(cw_label), [POINTER(cw_label_table), c_char_p]),
    "cw_label_table_add": (c_int, [POINTER(cw_label_table), POINTER(cw_label), POINTER(cw_error)]),
    "cw_label_color": (None, [c_uint32, POINTER(c_uint8)]),
    "cw_label_number": (c_char_p, [POINTER(cw_label), POINTER(c_char)]),
    "cw_label_parse": (c_bool, [c_char_p, POINTER(cw_label)]),
    "cw_label_ids_free": (None, [POINTER(cw_label_ids)]),
    "cw_label_ids_find": (c_uint32, [POINTER(cw_label_ids), POINTER(cw_label)]),
    "cw_label_ids_label": (cw_label, [POINTER(cw_label_ids), c_uint32]),
    "cw_labels_renumber": (c_int, [POINTER(c_int64), c_bool, c_size_t, POINTER(c_uint32), POINTER(cw_label_ids), POINTER(cw_error)]),
    "cw_label_table_renumber": (c_int, [POINTER(cw_label_table), POINTER(cw_label_ids), POINTER(cw_error)]),
    "cw_team_is_started": (c_bool, []),
    "cw_team_join": (c_int, [POINTER(cw_team), POINTER(cw_error)]),
    "cw_team_leave": (None, [POINTER(cw_team)]),
    "cw_team_gather": (c_int, [POINTER(cw_team), c_void_p, c_size_t, c_void_p, POINTER(cw_error)]),
    "cw_team_broadcast": (c_int, [POINTER(cw_team), c_int, c_void_p, c_size_t, POINTER(cw_error)]),
    "cw_team_agree": (c_int, [POINTER(cw_team), c_int, POINTER(cw_error)]),
    "cw_mesh_spool_new": (c_int, [c_char_p, POINTER(POINTER(cw_mesh_spool)), POINTER(cw_error)]),
    "cw_mesh_spool_free": (None, [POINTER(cw_mesh_spool)]),
    "cw_mesh_spool_sink": (cw_chunk_sink, [POINTER(cw_mesh_spool)]),
    "cw_mesh_spool_frame": (POINTER(cw_mesh), [POINTER(cw_mesh_spool)]),
    "cw_mesh_spool_bounds": (c_bool, [POINTER(cw_mesh_spool), POINTER(c_double), POINTER(c_double)]),
    "cw_mesh_spool_read": (c_int, [POINTER(cw_mesh_spool), cw_chunk_sink, POINTER(cw_error)]),
    "cw_mesh_spool_share": (c_int, [POINTER(cw_mesh_spool), POINTER(cw_team), POINTER(cw_error)]),
    "cw_mesh_spool_drop_volumes": (c_int, [POINTER(cw_mesh_spool), POINTER(cw_spool_drop_desc), cw_chunk_sink, POINTER(cw_drop_counts), POINTER(cw_error)]),
    "cw_fragment_write": (c_int, [c_char_p, POINTER(cw_fragment), POINTER(cw_mesh_spool), POINTER(cw_error)]),
    "cw_fragment_read": (c_int, [c_char_p, POINTER(cw_fragment), POINTER(cw_error)]),
    "cw_fragment_append": (c_int, [c_char_p, POINTER(cw_mesh_spool), POINTER(cw_error)]),
    "cw_stored_file_open": (c_int, [POINTER(cw_byte_source), POINTER(POINTER(cw_stored_file)), POINTER(cw_error)]),
    "cw_stored_file_close": (None, [POINTER(cw_stored_file)]),
    "cw_stored_file_size": (c_uint64, [POINTER(cw_stored_file)]),
    "cw_unit_name": (c_char_p, [c_int]),
    "cw_unit_mm": (c_double, [c_int]),
    "cw_volume_read": (c_int, [c_char_p, POINTER(cw_read_desc), POINTER(cw_volume), POINTER(c_char_p), POINTER(cw_error)]),
    "cw_volume_read_memory": (c_int, [POINTER(cw_byte_source), POINTER(cw_read_desc), POINTER(cw_volume), POINTER(c_char_p), POINTER(cw_error)]),
    "cw_label_ids_read": (c_int, [c_char_p, POINTER(cw_read_desc), c_size_t, POINTER(cw_label_ids), POINTER(cw_error)]),
    "cw_volume_visit": (c_int, [c_char_p, POINTER(cw_read_desc), c_size_t, c_size_t, POINTER(cw_slice_visitor), POINTER(c_char_p), POINTER(cw_error)]),
    "cw_steps_list": (c_int, [POINTER(c_char_p), c_size_t, POINTER(cw_read_desc), POINTER(POINTER(POINTER(c_char))), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_steps_free": (None, [POINTER(POINTER(c_char)), c_size_t]),
    "cw_arrays_list": (c_int, [c_char_p, POINTER(cw_read_desc), POINTER(POINTER(cw_array)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_arrays_free": (None, [POINTER(cw_array)]),
    "cw_levels_list": (c_int, [c_char_p, POINTER(cw_read_desc), POINTER(POINTER(cw_level)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_levels_free": (None, [POINTER(cw_level)]),
    "cw_series_list": (c_int, [c_char_p, POINTER(cw_read_desc), POINTER(POINTER(cw_series)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_series_free": (None, [POINTER(cw_series)]),
    "cw_label_table_read": (c_int, [c_char_p, POINTER(cw_label_table), POINTER(c_char_p), POINTER(cw_error)]),
    "cw_label_table_beside": (c_int, [c_char_p, POINTER(POINTER(c_char)), POINTER(cw_error)]),
    "cw_raw_layout_parse": (c_int, [c_char_p, POINTER(cw_raw_layout), POINTER(cw_error)]),
    "cw_mesh_read": (c_int, [c_char_p, POINTER(cw_mesh_read_desc), POINTER(cw_mesh), POINTER(cw_mesh_file), POINTER(cw_error)]),
    "cw_mesh_read_memory": (c_int, [POINTER(cw_byte_source), POINTER(cw_mesh_read_desc), POINTER(cw_mesh), POINTER(cw_mesh_file), POINTER(cw_error)]),
    "cw_texture_decode": (c_int, [POINTER(cw_texture), POINTER(cw_mesh_read_desc), POINTER(cw_image), POINTER(cw_error)]),
    "cw_parts_read": (c_int, [c_char_p, POINTER(cw_mesh_read_desc), POINTER(POINTER(cw_part)), POINTER(c_size_t), POINTER(cw_mesh_file), POINTER(cw_error)]),
    "cw_parts_free": (None, [POINTER(cw_part), c_size_t]),
    "cw_volume_write": (c_int, [c_char_p, POINTER(cw_volume), POINTER(cw_write_desc), POINTER(cw_error)]),
    "cw_mesh_write": (c_int, [c_char_p, POINTER(cw_mesh), POINTER(cw_write_desc), POINTER(cw_error)]),
    "cw_mesh_write_memory": (c_int, [c_char_p, POINTER(cw_mesh), POINTER(cw_write_desc), POINTER(POINTER(c_uint8)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_volume_write_memory": (c_int, [c_char_p, POINTER(cw_volume), POINTER(cw_write_desc), POINTER(POINTER(c_uint8)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_parts_write": (c_int, [c_char_p, POINTER(cw_part), c_size_t, POINTER(cw_write_desc), POINTER(cw_error)]),
    "cw_parts_write_with_consent": (c_int, [c_char_p, POINTER(cw_part), c_size_t, POINTER(cw_write_desc), POINTER(cw_write_consent), POINTER(cw_error)]),
    "cw_mesh_write_loss": (c_int, [c_char_p, POINTER(cw_mesh), POINTER(cw_write_desc), POINTER(cw_write_loss), POINTER(cw_error)]),
    "cw_parts_write_loss": (c_int, [c_char_p, POINTER(cw_part), c_size_t, POINTER(cw_write_desc), POINTER(cw_write_loss), POINTER(cw_error)]),
    "cw_mesh_write_check": (c_int, [c_char_p, POINTER(cw_write_desc), POINTER(cw_error)]),
    "cw_mesh_optimize": (c_int, [POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_pvd_read": (c_int, [c_char_p, POINTER(cw_read_desc), POINTER(POINTER(cw_pvd_entry)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_pvd_free": (None, [POINTER(cw_pvd_entry), c_size_t]),
    "cw_pvd_is": (c_bool, [c_char_p]),
    "cw_pvd_write": (c_int, [c_char_p, POINTER(cw_pvd_entry), c_size_t, POINTER(cw_write_desc), POINTER(cw_error)]),
    "cw_mesh_format": (POINTER(cw_format), [c_char_p, c_char_p]),
    "cw_volume_format": (POINTER(cw_format), [c_char_p, c_char_p]),
    "cw_formats": (POINTER(cw_format), [POINTER(c_size_t)]),
    "cw_mesh_close_handles": (c_int, [POINTER(cw_mesh), POINTER(cw_close_handles_desc), POINTER(cw_mesh), POINTER(cw_close_handles_facts), POINTER(cw_error)]),
    "cw_hard_at": (POINTER(cw_hard), [c_size_t]),
    "cw_hard_find": (c_bool, [c_char_p, POINTER(c_size_t)]),
    "cw_hard_stored": (c_double, [c_size_t, c_int, c_double]),
    "cw_hard_sample": (c_int, [POINTER(cw_hard_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_extract_labels": (c_int, [POINTER(cw_volume), POINTER(cw_labels_desc), POINTER(cw_label_surfaces), POINTER(cw_error)]),
    "cw_extract_labels_stream": (c_int, [POINTER(cw_slice_source), POINTER(cw_labels_desc), POINTER(cw_label_surfaces), POINTER(cw_error)]),
    "cw_extract_labels_predict": (c_int, [POINTER(cw_volume), POINTER(cw_labels_desc), POINTER(cw_label_prediction), POINTER(cw_error)]),
    "cw_extract_labels_stream_predict": (c_int, [POINTER(cw_slice_source), POINTER(cw_labels_desc), POINTER(cw_label_prediction), POINTER(cw_error)]),
    "cw_extract_label_scores": (c_int, [POINTER(cw_label_scores), POINTER(cw_labels_desc), POINTER(cw_label_surfaces), POINTER(cw_error)]),
    "cw_label_scores_largest": (c_int, [POINTER(cw_label_scores), c_uint32, c_int, POINTER(cw_volume), POINTER(cw_error)]),
    "cw_label_counts": (c_int, [POINTER(cw_volume), c_uint32, POINTER(POINTER(cw_label_count)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_label_counts_free": (None, [POINTER(cw_label_count)]),
    "cw_labels_clean": (c_int, [POINTER(cw_volume), POINTER(cw_label_clean_desc), POINTER(cw_volume), POINTER(POINTER(cw_label_change)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_label_changes_free": (None, [POINTER(cw_label_change)]),
    "cw_label_kernel_name": (c_char_p, [c_int]),
    "cw_labels_resample": (c_int, [POINTER(cw_volume), POINTER(cw_label_resample_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_label_surfaces_free": (None, [POINTER(cw_label_surfaces)]),
    "cw_label_mesh": (c_int, [POINTER(cw_label_surfaces), c_uint32, POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_label_patch_mesh": (c_int, [POINTER(cw_label_surfaces), POINTER(cw_label_patch), POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_label_colored_mesh": (c_int, [POINTER(cw_label_surfaces), POINTER(c_uint8 * 4), POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_label_patch_area": (c_double, [POINTER(cw_label_surfaces), POINTER(cw_label_patch)]),
    "cw_label_volumes": (None, [POINTER(cw_label_surfaces), POINTER(c_double)]),
    "cw_label_simplify": (c_int, [POINTER(cw_label_surfaces), POINTER(cw_label_simplify_desc), POINTER(cw_label_surfaces), POINTER(cw_error)]),
    "cw_level_set_available": (c_bool, []),
    "cw_level_set_from_mesh": (c_int, [POINTER(cw_mesh), POINTER(cw_level_set_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_mesh_offset": (c_int, [POINTER(cw_mesh), POINTER(cw_offset_desc), POINTER(cw_mesh), POINTER(cw_offset_facts), POINTER(cw_error)]),
    "cw_infill_name": (c_char_p, [c_int]),
    "cw_mesh_hollow": (c_int, [POINTER(cw_mesh), POINTER(cw_hollow_desc), POINTER(cw_mesh), POINTER(cw_hollow_facts), POINTER(cw_error)]),
    "cw_transfer_check": (c_int, [POINTER(cw_transfer), POINTER(cw_error)]),
    "cw_transfer_at": (None, [POINTER(cw_transfer), c_double, POINTER(c_double), POINTER(c_double)]),
    "cw_transfer_gradient_factor": (c_double, [POINTER(cw_transfer), c_double]),
    "cw_transfer_index": (c_double, [POINTER(cw_transfer), c_double]),
    "cw_transfer_set_materials": (c_int, [POINTER(cw_transfer), POINTER(cw_material_class), c_size_t, POINTER(cw_error)]),
    "cw_transfer_preset_name": (c_char_p, [c_size_t]),
    "cw_transfer_preset_about": (c_char_p, [c_size_t]),
    "cw_transfer_preset": (c_int, [c_char_p, POINTER(cw_statistics), POINTER(cw_transfer), POINTER(cw_error)]),
    "cw_transfer_box": (c_int, [POINTER(cw_volume), POINTER(cw_transfer), c_int, POINTER(c_double), POINTER(c_double), POINTER(cw_error)]),
    "cw_transfer_read": (c_int, [c_char_p, POINTER(cw_transfer), POINTER(cw_error)]),
    "cw_transfer_write": (c_int, [c_char_p, POINTER(cw_transfer), POINTER(cw_error)]),
    "cw_transfer_parse": (c_int, [c_char_p, POINTER(cw_transfer), POINTER(cw_error)]),
    "cw_transfer_format": (c_int, [POINTER(cw_transfer), POINTER(c_char), POINTER(cw_error)]),
    "cw_mode_name": (c_char_p, [c_int]),
    "cw_mode_about": (c_char_p, [c_int]),
    "cw_mode_source": (c_char_p, [c_int]),
    "cw_mode_is_intensity": (c_bool, [c_int]),
    "cw_mode_draws": (c_bool, [c_int, POINTER(cw_volume)]),
    "cw_renderer_new": (c_int, [c_int, POINTER(POINTER(cw_renderer)), POINTER(cw_error)]),
    "cw_renderer_free": (None, [POINTER(cw_renderer)]),
    "cw_renderer_name": (c_char_p, [POINTER(cw_renderer)]),
    "cw_render": (c_int, [POINTER(cw_renderer), POINTER(cw_scene), POINTER(cw_picture), POINTER(cw_error)]),
    "cw_renderer_prepare": (c_int, [POINTER(cw_renderer), POINTER(cw_live_surface), POINTER(c_bool), POINTER(cw_error)]),
    "cw_pick": (c_int, [POINTER(cw_scene), POINTER(c_double), POINTER(cw_picked), POINTER(cw_error)]),
    "cw_slice_camera": (c_int, [POINTER(cw_volume), POINTER(cw_clip), c_double, POINTER(cw_camera), POINTER(cw_error)]),
    "cw_renderer_forget": (None, [POINTER(cw_renderer)]),
    "cw_render_mesh": (c_int, [POINTER(cw_mesh), POINTER(cw_render_mesh_desc), POINTER(cw_image), POINTER(cw_error)]),
    "cw_overlay_draw": (c_int, [POINTER(cw_overlay), POINTER(cw_scene), POINTER(cw_image), POINTER(cw_error)]),
    "cw_scale_bar": (c_int, [POINTER(cw_scene), POINTER(cw_image), POINTER(c_double), POINTER(c_double), POINTER(cw_error)]),
    "cw_label_slices_draw": (c_int, [POINTER(cw_label_slices), POINTER(cw_scene), POINTER(cw_picture), POINTER(cw_error)]),
    "cw_value_slices_draw": (c_int, [POINTER(cw_value_slices), POINTER(cw_scene), POINTER(cw_picture), POINTER(cw_error)]),
    "cw_world_marks_draw": (c_int, [POINTER(cw_world_mark), c_size_t, c_double, POINTER(cw_scene), POINTER(cw_image), POINTER(cw_error)]),
    "cw_image_place": (None, [POINTER(cw_image), POINTER(cw_image), c_ssize_t, c_ssize_t]),
    "cw_image_tile": (c_int, [POINTER(cw_image), c_size_t, c_size_t, c_size_t, POINTER(c_uint8), POINTER(cw_image), POINTER(cw_error)]),
    "cw_pieces_cut": (c_int, [POINTER(cw_mesh), POINTER(cw_cut_desc), c_size_t, POINTER(cw_pieces_desc), POINTER(cw_pieces), POINTER(cw_error)]),
    "cw_pieces_free": (None, [POINTER(cw_pieces)]),
    "cw_plate_planes": (c_int, [POINTER(cw_mesh), POINTER(cw_plate_desc), POINTER(POINTER(cw_cut_desc)), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_planes_free": (None, [POINTER(cw_cut_desc)]),
    "cw_pieces_lay": (c_int, [POINTER(cw_pieces), POINTER(cw_lay_desc), POINTER(c_size_t), POINTER(cw_error)]),
    "cw_pieces_assemble": (c_int, [POINTER(cw_pieces), POINTER(cw_mesh), c_int, POINTER(cw_progress), POINTER(cw_assembled), POINTER(cw_error)]),
    "cw_simplify_view_draw": (c_int, [POINTER(cw_simplify_view), POINTER(cw_mesh), POINTER(cw_error)]),
    "cw_simplify_view_free": (None, [POINTER(cw_simplify_view)]),
    "cw_simplify_view_error": (c_int, [POINTER(cw_simplify_view), c_double, POINTER(c_double), POINTER(c_double), POINTER(cw_error)]),
    "cw_simplify_view_sees": (c_int, [POINTER(cw_simplify_view), c_double, POINTER(c_double), c_size_t, POINTER(c_bool), POINTER(cw_error)]),
    "cw_simplify_views_error": (c_int, [POINTER(cw_simplify_view), c_size_t, c_double, POINTER(c_double), c_size_t, POINTER(c_double), POINTER(cw_error)]),
    "cw_simplify_views_box": (c_int, [POINTER(cw_volume), POINTER(cw_simplify_view), c_size_t, POINTER(cw_box), POINTER(cw_error)]),
    "cw_simplify_view_distance": (c_int, [POINTER(cw_simplify_view), POINTER(cw_mesh), POINTER(c_float), POINTER(c_double), POINTER(cw_error)]),
    "cw_simplify_cull": (c_int, [POINTER(cw_mesh), POINTER(cw_simplify_view), c_size_t, c_double, c_double, POINTER(c_size_t), POINTER(cw_error)]),
    "cw_simplify": (c_int, [POINTER(cw_mesh), POINTER(cw_simplify_desc), POINTER(cw_mesh), POINTER(cw_simplify_facts), POINTER(cw_error)]),
    "cw_simplify_levels": (c_int, [POINTER(cw_mesh), POINTER(cw_simplify_desc), POINTER(c_size_t), c_size_t, POINTER(cw_mesh), POINTER(cw_simplify_facts), POINTER(cw_error)]),
    "cw_simplifier_new": (c_int, [POINTER(cw_simplify_desc), POINTER(POINTER(cw_simplifier)), POINTER(cw_error)]),
    "cw_simplifier_free": (None, [POINTER(cw_simplifier)]),
    "cw_simplifier_take": (c_int, [c_void_p, POINTER(cw_slab), POINTER(cw_error)]),
    "cw_simplifier_finish": (c_int, [POINTER(cw_simplifier), POINTER(cw_mesh), POINTER(cw_simplify_facts), POINTER(cw_error)]),
    "cw_simplify_available": (c_bool, []),
    "cw_smooth_method_name": (c_char_p, [c_int]),
    "cw_mesh_smooth": (c_int, [POINTER(cw_mesh), POINTER(cw_smooth_desc), POINTER(cw_smooth_facts), POINTER(cw_error)]),
    "cw_stage_name": (c_char_p, [c_int]),
    "cw_pipeline_stages": (c_uint, [POINTER(cw_pipeline_desc)]),
    "cw_pipeline_check": (c_int, [c_int, c_uint, POINTER(c_int), POINTER(c_int), POINTER(cw_error)]),
    "cw_pipeline_run": (c_int, [POINTER(cw_volume), POINTER(cw_extractor), POINTER(cw_pipeline_desc), cw_pipeline_sink, POINTER(cw_pipeline_facts), POINTER(cw_error)]),
    "cw_pipeline_mesh": (c_int, [POINTER(cw_volume), POINTER(cw_extractor), POINTER(cw_pipeline_desc), POINTER(cw_mesh), POINTER(cw_pipeline_facts), POINTER(cw_error)]),
    "cw_pipeline_run_slices": (c_int, [POINTER(cw_slice_source), POINTER(cw_pipeline_desc), cw_pipeline_sink, POINTER(cw_pipeline_facts), POINTER(cw_error)]),
    "cw_pipeline_run_mesh": (c_int, [POINTER(cw_mesh), POINTER(cw_pipeline_desc), cw_pipeline_sink, POINTER(cw_pipeline_facts), POINTER(cw_error)]),
    "cw_pipeline_run_labels": (c_int, [POINTER(cw_pipeline_labels), POINTER(cw_pipeline_desc), cw_pipeline_sink, POINTER(cw_pipeline_facts), POINTER(cw_error)]),
    "cw_mesh_remesh": (c_int, [POINTER(cw_mesh), POINTER(cw_remesh_desc), POINTER(cw_mesh), POINTER(cw_remesh_facts), POINTER(cw_error)]),
    "cw_repair_has_cgal": (c_bool, []),
    "cw_mesh_repair": (c_int, [POINTER(cw_mesh), POINTER(cw_repair_desc), POINTER(cw_mesh), POINTER(cw_repair_facts), POINTER(cw_error)]),
    "cw_slice_filter_bytes": (c_size_t, [POINTER(cw_volume), POINTER(cw_slice_filter_desc)]),
    "cw_slice_filter_new": (c_int, [POINTER(cw_slice_source), POINTER(cw_slice_filter_desc), POINTER(POINTER(cw_slice_filter)), POINTER(cw_error)]),
    "cw_slice_filter_source": (cw_slice_source, [POINTER(cw_slice_filter)]),
    "cw_slice_filter_free": (None, [POINTER(cw_slice_filter)]),
    "cw_voxelize": (c_int, [POINTER(POINTER(cw_mesh)), c_size_t, POINTER(cw_voxelize_desc), POINTER(cw_volume), POINTER(cw_error)]),
    "cw_volume_within": (c_int, [POINTER(cw_volume), POINTER(cw_mesh), c_int, POINTER(cw_within), POINTER(cw_error)]),
}

VARIABLES: dict[str, Any] = {
    "cw_aspect_ends": c_double * 8,
}
