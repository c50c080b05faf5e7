/* Applies the coordinate transformations of OME-Zarr to the frame of an image. */
#include "core/base/status.h"
#include "formats/zarr/zarr_image.h"

#include <stdio.h>
#include <string.h>

enum { MAX_NESTING = 8, MAX_STEPS = 64 };

typedef double square_matrix[CWI_ZARR_RANK][CWI_ZARR_RANK + 1];

/* Replaces the matrix of a frame by that of the frame, then `next`. */
static void append_matrix(cwi_zarr_frame *frame, square_matrix next)
{
    const size_t rank = frame->rank;
    square_matrix result;
    for (size_t r = 0; r < rank; r++)
        for (size_t c = 0; c <= rank; c++) {
            result[r][c] = c == rank ? next[r][rank] : 0;
            for (size_t k = 0; k < rank; k++)
                result[r][c] += next[r][k] * frame->matrix[k][c];
        }
    memcpy(frame->matrix, result, sizeof result);
}

/* Reads a matrix of `columns` columns: rows as lists. */
static cw_status read_rows(const json_t *step, const char *key, size_t rank, size_t columns,
                           square_matrix out, cw_error *err)
{
    const json_t *rows = json_object_get(step, key);
    if (json_array_size(rows) != rank)
        return cwi_zarr_fail(err, step, key, "a list of rows, one an axis,");
    for (size_t r = 0; r < rank; r++) {
        const json_t *row = json_array_get(rows, r);
        if (json_array_size(row) != columns)
            return cwi_zarr_fail(err, step, key, "rows of as many numbers as there are axes");
        for (size_t c = 0; c < columns; c++) {
            if (!json_is_number(json_array_get(row, c)))
                return cwi_zarr_fail(err, step, key, "rows of numbers");
            out[r][c] = json_number_value(json_array_get(row, c));
        }
    }
    return CW_OK;
}

/* Reads a permutation of axes: for each axis of the output its axis of the input. */
static cw_status read_mapping(const json_t *step, size_t rank, square_matrix out, cw_error *err)
{
    double numbers[CWI_ZARR_RANK];
    cw_status st = cwi_zarr_numbers(step, "mapAxis", rank, numbers, err);
    memset(out, 0, sizeof(square_matrix));
    for (size_t r = 0; st == CW_OK && r < rank; r++) {
        if (!(numbers[r] >= 0 && numbers[r] < (double)rank))
            return cwi_zarr_fail(err, step, "mapAxis", "a list of axes");
        out[r][(size_t)numbers[r]] = 1;
    }
    return st;
}

static cw_status apply_list(const json_t *object, const char *key, cwi_zarr_frame *frame,
                            int depth, cw_error *err);

static cw_status apply_step(const json_t *step, cwi_zarr_frame *frame, int depth, cw_error *err)
{
    const size_t rank = frame->rank;
    const char *type = cwi_zarr_text(step, "type");
    double numbers[CWI_ZARR_RANK];
    square_matrix next = {{0}};
    cw_status st = CW_OK;
    for (size_t r = 0; r < rank; r++)
        next[r][r] = 1;
    if (!type)
        return cwi_zarr_fail(err, step, "type", "\"scale\" or \"translation\"");
    if (strcmp(type, "scale") == 0) {
        st = cwi_zarr_numbers(step, "scale", rank, numbers, err);
        for (size_t r = 0; st == CW_OK && r < rank; r++)
            next[r][r] = numbers[r];
    } else if (strcmp(type, "translation") == 0) {
        st = cwi_zarr_numbers(step, "translation", rank, numbers, err);
        for (size_t r = 0; st == CW_OK && r < rank; r++)
            next[r][rank] = numbers[r];
    } else if (strcmp(type, "affine") == 0) {
        st = read_rows(step, "affine", rank, rank + 1, next, err);
    } else if (strcmp(type, "rotation") == 0) {
        st = read_rows(step, "rotation", rank, rank, next, err);
    } else if (strcmp(type, "mapAxis") == 0) {
        st = read_mapping(step, rank, next, err);
    } else if (strcmp(type, "sequence") == 0) {
        return apply_list(step, "transformations", frame, depth + 1, err);
    } else if (strcmp(type, "identity") != 0) {
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'type' of a coordinate transformation is '%.40s'; those that are read "
                        "are identity, scale, translation, affine, rotation, mapAxis, sequence",
                        type);
    }
    if (st == CW_OK)
        append_matrix(frame, next);
    return st;
}

static cw_status apply_list(const json_t *object, const char *key, cwi_zarr_frame *frame,
                            int depth, cw_error *err)
{
    const json_t *list = json_object_get(object, key);
    cw_status st = CW_OK;
    if (cwi_zarr_is_absent(object, key))
        return CW_OK;
    if (!json_is_array(list))
        return cwi_zarr_fail(err, object, key, "a list of transformations");
    if (depth > MAX_NESTING || json_array_size(list) > MAX_STEPS)
        return cwi_fail(err, CW_ERR_LIMIT, "'%s' has more than %d steps, or %d nested lists",
                        key, MAX_STEPS, MAX_NESTING);
    for (size_t n = 0; st == CW_OK && n < json_array_size(list); n++)
        st = apply_step(json_array_get(list, n), frame, depth, err);
    return st;
}

cw_status cwi_zarr_transform(const json_t *object, cwi_zarr_frame *frame, cw_error *err)
{
    return apply_list(object, "coordinateTransformations", frame, 0, err);
}
