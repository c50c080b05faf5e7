/* Reads the corners of cells from VTK's lists, and converts them to the order of our shapes. */
#include "formats/cells/cell_connectivity.h"

#include "core/base/status.h"
#include "formats/cells/vtk_cell_types.h"

/* Finds the end of the next cell's numbers. */
static cw_status find_end(cwi_corner_list *list, size_t *out, cw_error *err)
{
    const size_t there = list->numbers.count;
    int64_t end;
    if (list->counted) {
        const int64_t count =
            list->at < there ? cwi_tuples_whole(&list->numbers, list->at) : -1;
        if (count < 0 || (uint64_t)count > there - list->at - 1)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'CELLS' ends within cell %zu: it lists %zu numbers", list->cell,
                            there);
        list->at++;
        end = (int64_t)list->at + count;
    } else {
        end = cwi_tuples_whole(&list->ends, list->cell);
        if (end < (int64_t)list->at || (uint64_t)end > there)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'offsets' says that cell %zu ends at %lld; it starts at %zu, and "
                            "the last ends at %zu",
                            list->cell, (long long)end, list->at, there);
    }
    *out = (size_t)end;
    return CW_OK;
}

/* Converts the corners of a cell that has `there` numbers left. */
static cw_status take_corners(const cwi_corner_list *list, const cwi_cell_kind *kind,
                              size_t there, size_t base, uint32_t *to, cw_error *err)
{
    static const uint8_t in_rows[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    const size_t expected = cwi_shape_corners(kind->shape);
    const bool curved = kind->use == CWI_CELL_CURVED;
    if (curved ? there < expected : there != expected)
        return cwi_fail(err, CW_ERR_FORMAT, "cell %zu, a %s, has %zu corners; %s%zu expected",
                        list->cell, kind->name, there, curved ? "at least " : "", expected);
    for (size_t c = 0; c < expected; c++) {
        const size_t step = kind->use == CWI_CELL_VOXEL ? in_rows[c] : c;
        const int64_t corner = cwi_tuples_whole(&list->numbers, list->at + step);
        if (corner < 0 || (uint64_t)corner >= list->points)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "cell %zu has the corner %lld; '%s' says that there are %zu",
                            list->cell, (long long)corner, list->point_field, list->points);
        to[c] = (uint32_t)(base + (size_t)corner);
    }
    return CW_OK;
}

cw_status cwi_corner_list_next(cwi_corner_list *list, uint8_t type, size_t base, uint32_t *to,
                               size_t *count, cw_error *err)
{
    const cwi_cell_kind *kind = cwi_cell_kind_find(type);
    size_t end = 0;
    *count = 0;
    cw_status st = find_end(list, &end, err);
    if (st == CW_OK && type != CWI_VTK_EMPTY) {
        st = take_corners(list, kind, end - list->at, base, to, err);
        *count = cwi_shape_corners(kind->shape);
    }
    list->at = end;
    list->cell++;
    return st;
}
