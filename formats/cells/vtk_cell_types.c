/* Maps VTK's cell types to our shapes, and gives their names and numbers of corners. */
#include "formats/cells/vtk_cell_types.h"

#define FLAT(name)                                                                             \
    {                                                                                          \
        name, CWI_CELL_FLAT, CW_SHAPE_COUNT                                                    \
    }
#define REFUSED(name)                                                                          \
    {                                                                                          \
        name, CWI_CELL_REFUSED, CW_SHAPE_COUNT                                                 \
    }
#define LINEAR(name, shape)                                                                    \
    {                                                                                          \
        name, CWI_CELL_LINEAR, shape                                                           \
    }
#define CURVED(name, shape)                                                                    \
    {                                                                                          \
        name, CWI_CELL_CURVED, shape                                                           \
    }

/* The kinds of cells by VTK's number (vtkCellType.h). */
static const cwi_cell_kind kinds[] = {
    [CWI_VTK_EMPTY] = FLAT("empty cell"),
    [1] = FLAT("vertex"),
    [2] = FLAT("poly-vertex"),
    [3] = FLAT("line"),
    [4] = FLAT("poly-line"),
    [5] = FLAT("triangle"),
    [6] = FLAT("triangle strip"),
    [7] = FLAT("polygon"),
    [8] = FLAT("pixel"),
    [9] = FLAT("quad"),
    [10] = LINEAR("tetrahedron", CW_TETRAHEDRON),
    [11] = {"voxel", CWI_CELL_VOXEL, CW_HEXAHEDRON},
    [CWI_VTK_HEXAHEDRON] = LINEAR("hexahedron", CW_HEXAHEDRON),
    [13] = LINEAR("wedge", CW_WEDGE),
    [14] = LINEAR("pyramid", CW_PYRAMID),
    [15] = REFUSED("pentagonal prism"),
    [16] = REFUSED("hexagonal prism"),
    [21] = FLAT("quadratic edge"),
    [22] = FLAT("quadratic triangle"),
    [23] = FLAT("quadratic quad"),
    [24] = CURVED("quadratic tetrahedron", CW_TETRAHEDRON),
    [25] = CURVED("quadratic hexahedron", CW_HEXAHEDRON),
    [26] = CURVED("quadratic wedge", CW_WEDGE),
    [27] = CURVED("quadratic pyramid", CW_PYRAMID),
    [28] = FLAT("biquadratic quad"),
    [29] = CURVED("triquadratic hexahedron", CW_HEXAHEDRON),
    [30] = FLAT("quadratic-linear quad"),
    [31] = CURVED("quadratic-linear wedge", CW_WEDGE),
    [32] = CURVED("biquadratic-quadratic wedge", CW_WEDGE),
    [33] = CURVED("biquadratic-quadratic hexahedron", CW_HEXAHEDRON),
    [34] = FLAT("biquadratic triangle"),
    [35] = FLAT("cubic line"),
    [36] = FLAT("quadratic polygon"),
    [37] = CURVED("triquadratic pyramid", CW_PYRAMID),
    [41] = REFUSED("convex point set"),
    [42] = REFUSED("polyhedron"),
    [68] = FLAT("Lagrange curve"),
    [69] = FLAT("Lagrange triangle"),
    [70] = FLAT("Lagrange quad"),
    [71] = CURVED("Lagrange tetrahedron", CW_TETRAHEDRON),
    [72] = CURVED("Lagrange hexahedron", CW_HEXAHEDRON),
    [73] = CURVED("Lagrange wedge", CW_WEDGE),
    [74] = CURVED("Lagrange pyramid", CW_PYRAMID),
    [75] = FLAT("Bezier curve"),
    [76] = FLAT("Bezier triangle"),
    [77] = FLAT("Bezier quad"),
    [78] = CURVED("Bezier tetrahedron", CW_TETRAHEDRON),
    [79] = CURVED("Bezier hexahedron", CW_HEXAHEDRON),
    [80] = CURVED("Bezier wedge", CW_WEDGE),
    [81] = CURVED("Bezier pyramid", CW_PYRAMID),
};

const cwi_cell_kind *cwi_cell_kind_find(int64_t type)
{
    const bool is_row = type >= 0 && (size_t)type < sizeof kinds / sizeof *kinds;
    return is_row && kinds[type].use != CWI_CELL_UNKNOWN ? &kinds[type] : NULL;
}

size_t cwi_shape_corners(cw_shape shape)
{
    static const size_t corners[CW_SHAPE_COUNT] = {
        [CW_TETRAHEDRON] = 4, [CW_PYRAMID] = 5, [CW_WEDGE] = 6, [CW_HEXAHEDRON] = 8};
    return corners[shape];
}
