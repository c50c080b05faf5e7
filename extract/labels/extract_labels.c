/* Extracts the interfaces of a label map in chunks, so that the result does not depend on threads:
 * assembles what the first pass counted, and smooths what the second one wrote. */
#include "extract/labels/extract_labels.h"

#include "core/geometry/vec3.h"
#include "extract/labels/label_chunks.h"
#include "extract/labels/label_smooth.h"
#include "extract/labels/label_untangle.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    PLACES = 1 << 14, /* vertices */
    WORK = 4          /* cost of a voxel, relative to those of other loops */
};

/* Tetrahedra of a cube that is not one point have vertices this far from the cube's middle to
 * their own: near it, so that sheets stay apart and close to where surface nets have them. */
static const double NEAR_FRACTION = 0.5;

static const cwi_label_smoother averages = {cwi_labels_smooth, NULL};

/* Vertices stay at least this far inside of their cubes, in voxels. */
#define MARGIN 1e-3

/* Returns the coordinate of a fractional index along an axis, from -1 to its number of voxels. */
static double find_coordinate(const cw_volume *v, int axis, double index)
{
    if (!v->coordinates[axis])
        return index;
    const double last = (double)v->dim[axis] - 1, low = fmin(floor(index), last);
    if (v->dim[axis] > 1)
        return cwi_grid_coordinate(v, axis, (ptrdiff_t)low, index - low);
    return v->coordinates[axis][0] + index;
}

/* Converts voxel indices to a world point, from the mesh's origin. */
static void index_to_point(const void *context, const double index[3], double point[3])
{
    const cwi_label_job *j = context;
    const cw_volume *v = j->layers.volume;
    double at[3], world[3];
    for (int a = 0; a < 3; a++)
        at[a] = find_coordinate(v, a, index[a]);
    cwi_affine_apply(v->affine[0], at, world);
    cwi_sub(world, j->out->mesh.origin, point);
}

static void place_part(void *context, size_t n)
{
    const cwi_label_job *j = context;
    const size_t count = j->out->mesh.vertex_count;
    for (size_t i = n * PLACES; i < (n + 1) * PLACES && i < count; i++) {
        const float *from = (j->places ? j->places : j->out->mesh.positions) + 3 * i;
        float *p = j->out->mesh.positions + 3 * i;
        double index[3] = {(double)from[0], (double)from[1], (double)from[2]}, point[3];
        index_to_point(j, index, point);
        for (int a = 0; a < 3; a++)
            p[a] = (float)point[a];
    }
}

/* A pair's triangles in a chunk. */
typedef struct part {
    uint64_t key;
    size_t chunk;
    cwi_key_count *entry;
} part;

static int compare_parts(const void *a, const void *b)
{
    const part *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->chunk < y->chunk ? -1 : x->chunk > y->chunk;
}

/* Lists the entries of all chunks' pairs, or of their voxels, by key and then by chunk. Returns
 * NULL when memory is out. */
static part *list_parts(const cwi_label_job *j, size_t chunks, bool of_voxels, size_t *count)
{
    *count = 0;
    for (size_t c = 0; c < chunks; c++)
        *count += of_voxels ? j->chunks[c].voxels.used : j->chunks[c].pairs.used;
    part *parts = cwi_alloc_array(*count, sizeof *parts);
    size_t n = 0;
    for (size_t c = 0; c < chunks && parts; c++) {
        const cwi_key_counts *t = of_voxels ? &j->chunks[c].voxels : &j->chunks[c].pairs;
        for (size_t e = 0; e < t->size; e++)
            if (t->entries[e].key != 0)
                parts[n++] = (part){t->entries[e].key, c, &t->entries[e]};
    }
    if (parts)
        qsort(parts, n, sizeof *parts, compare_parts);
    return parts;
}

static size_t count_keys(const part *parts, size_t count)
{
    size_t keys = 0;
    for (size_t n = 0; n < count; n++)
        keys += n == 0 || parts[n].key != parts[n - 1].key;
    return keys;
}

/* Sums up the voxels of each label. */
static cw_status list_labels(const cwi_label_job *j, size_t chunks, cw_error *err)
{
    cw_label_surfaces *out = j->out;
    size_t count;
    part *parts = list_parts(j, chunks, true, &count);
    if (parts)
        out->labels = cwi_alloc_zeroed(count_keys(parts, count), sizeof *out->labels);
    for (size_t n = 0; n < count && parts && out->labels; n++) {
        if (n == 0 || parts[n].key != parts[n - 1].key)
            out->labels[out->label_count++].label = (uint32_t)(parts[n].key - 1);
        out->labels[out->label_count - 1].voxels += parts[n].entry->count;
    }
    cwi_free(parts);
    return out->labels ? CW_OK : cwi_fail_memory(err);
}

/* Makes the patches, and turns counts of triangles into the places of each chunk's first. */
static cw_status list_patches(const cwi_label_job *j, size_t chunks, cw_error *err)
{
    cw_label_surfaces *out = j->out;
    size_t count;
    part *parts = list_parts(j, chunks, false, &count);
    if (parts)
        out->patches = cwi_alloc_zeroed(count_keys(parts, count), sizeof *out->patches);
    for (size_t n = 0; n < count && parts && out->patches; n++) {
        const uint64_t key = parts[n].key;
        if (n == 0 || key != parts[n - 1].key)
            out->patches[out->patch_count++] = (cw_label_patch){
                {(uint32_t)(key >> 32), (uint32_t)key}, out->mesh.triangle_count, 0};
        const size_t triangles = parts[n].entry->count;
        parts[n].entry->count = out->mesh.triangle_count;
        out->patches[out->patch_count - 1].count += triangles;
        out->mesh.triangle_count += triangles;
    }
    cwi_free(parts);
    return out->patches ? CW_OK : cwi_fail_memory(err);
}

/* Turns counts of vertices into the number of each chunk's first. */
static cw_status number_vertices(const cwi_label_job *j, size_t chunks, cw_error *err)
{
    size_t sum = 0;
    for (size_t c = 0; c < chunks; c++) {
        const size_t count = j->chunks[c].vertices;
        j->chunks[c].vertices = sum;
        sum += count;
    }
    j->out->mesh.vertex_count = sum;
    if (sum >= UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "the labels make %zu vertices: at most 2^32 - 2 can be numbered", sum);
    return CW_OK;
}

/* Estimates the bytes of all arrays that are there at one time, with directions in several patches for a
 * third of the vertices. */
static size_t estimate_bytes(const cw_mesh *mesh, bool is_smooth)
{
    enum { PLACE = 12, CORNERS = 12, SMOOTHED_VERTEX = 88, SMOOTHED_TRIANGLE = 29 };
    return is_smooth
               ? SMOOTHED_VERTEX * mesh->vertex_count + SMOOTHED_TRIANGLE * mesh->triangle_count
               : PLACE * mesh->vertex_count + CORNERS * mesh->triangle_count;
}

static cw_status ensure_capacity(cwi_label_job *j, const cw_labels_desc *desc, cw_error *err)
{
    const cw_volume *v = j->layers.volume;
    cwi_label_net *net = &j->net;
    cw_mesh *mesh = &j->out->mesh;
    double middle[3];
    if (desc->max_triangles > 0 && mesh->triangle_count > desc->max_triangles)
        return cwi_fail(err, CW_ERR_LIMIT, "the labels make %zu triangles, more than %zu",
                        mesh->triangle_count, desc->max_triangles);
    cw_status st = cwi_memory_expect(estimate_bytes(mesh, !desc->no_smoothing), err);
    if (st != CW_OK)
        return st;
    mesh->positions =
        cwi_alloc_large(mesh->vertex_count + CWI_SPARE_POSITIONS, 3 * sizeof *mesh->positions);
    mesh->triangles = cwi_alloc_large(mesh->triangle_count, 3 * sizeof *mesh->triangles);
    if (!desc->no_smoothing && mesh->vertex_count > 0) {
        net->neighbours = cwi_alloc_large(mesh->vertex_count, sizeof *net->neighbours);
        net->kinds = cwi_alloc_zeroed(mesh->vertex_count, 1);
        net->polygons = cwi_alloc_large(mesh->triangle_count, 1);
        j->originals =
            cwi_alloc_large(mesh->vertex_count + CWI_SPARE_POSITIONS, 3 * sizeof *j->originals);
        j->places =
            cwi_alloc_large(mesh->vertex_count + CWI_SPARE_POSITIONS, 3 * sizeof *j->places);
        if (net->neighbours)
            cwi_set_large(net->neighbours, 0xff, mesh->vertex_count * sizeof *net->neighbours);
    }
    if (!mesh->positions || !mesh->triangles ||
        (!desc->no_smoothing && mesh->vertex_count > 0 &&
         !(net->neighbours && net->kinds && net->polygons && j->originals && j->places)))
        return cwi_fail_memory(err);
    for (int a = 0; a < 3; a++)
        middle[a] =
            0.5 * (find_coordinate(v, a, 0) + find_coordinate(v, a, (double)v->dim[a] - 1));
    cwi_affine_apply(v->affine[0], middle, mesh->origin);
    memcpy(mesh->affine, v->affine, sizeof mesh->affine);
    return CW_OK;
}

/* Fills in the prediction. */
static void predict_job(const cwi_label_job *j, const cw_labels_desc *desc)
{
    const cw_label_surfaces *out = j->out;
    cw_label_prediction *p = j->prediction;
    *p = (cw_label_prediction){.labels = out->label_count,
                               .patches = out->patch_count,
                               .vertices = out->mesh.vertex_count,
                               .triangles = out->mesh.triangle_count};
    for (size_t n = 0; n < out->patch_count; n++) {
        const cw_label_patch *patch = &out->patches[n];
        p->own_triangles += (patch->labels[1] == out->background ? 1 : 2) * patch->count;
    }
    p->bytes = estimate_bytes(&out->mesh, !desc->no_smoothing);
}

/* Goes through chunks whose slices are in memory. */
static cw_status run_chunks(cwi_label_job *j, size_t first, size_t count,
                            const cw_labels_desc *desc, const cw_progress *progress,
                            cw_error *err)
{
    const cw_volume *v = j->layers.volume;
    j->first_chunk = first;
    cw_status st = cwi_parallel_for(
        count, WORK * CWI_LABEL_CHUNK * v->dim[0] * v->dim[1], desc->threads, progress,
        j->is_writing ? "extracting" : "counting", cwi_label_chunk_work, j, err);
    if (st == CW_OK && j->is_starved)
        return cwi_fail_memory(err);
    if (st == CW_OK && j->is_bad)
        return cwi_label_fail_voxel(&j->layers, j->bad, err);
    return st;
}

/* Goes through all chunks, a window of slices after the other. */
static cw_status run_windows(cwi_label_job *j, size_t chunks, const cw_labels_desc *desc,
                             cw_error *err)
{
    cw_volume view = *j->layers.volume;
    cwi_label_window *w = j->window;
    cw_status st = CW_OK;
    w->count = 0; /* each pass reads from the start */
    for (size_t n = 0; n < chunks && st == CW_OK; n += w->chunks) {
        const size_t count = chunks - n < w->chunks ? chunks - n : w->chunks;
        const cwi_part_progress span = {.whole = &desc->progress,
                                        .from = (double)n / (double)chunks,
                                        .fraction = (double)count / (double)chunks};
        const cw_progress progress = cwi_progress_part(&span);
        st = cwi_label_window_move(w, &j->layers, n, count, err);
        view.data = w->slices;
        j->layers.volume = &view;
        j->layers.first_slice = w->first;
        if (st == CW_OK)
            st = run_chunks(j, n, count, desc, &progress, err);
    }
    j->layers.volume = &w->whole;
    j->layers.first_slice = 0;
    return st;
}

static cw_status run_pass(cwi_label_job *j, size_t chunks, const cw_labels_desc *desc,
                          cw_error *err)
{
    return j->window ? run_windows(j, chunks, desc, err)
                     : run_chunks(j, 0, chunks, desc, &desc->progress, err);
}

static cw_status place_all(cwi_label_job *j, const cw_labels_desc *desc, cw_error *err)
{
    return cwi_parallel_for((j->out->mesh.vertex_count + PLACES - 1) / PLACES, PLACES,
                            desc->threads, &desc->progress, "placing", place_part, j, err);
}

/* Smooths all vertices, gives labels their volumes, and puts vertices back where triangles cross. */
static cw_status smooth_all(cwi_label_job *j, const cw_labels_desc *desc,
                            const cwi_label_smoother *smooth, cw_error *err)
{
    cw_mesh *mesh = &j->out->mesh;
    const size_t *dim = j->layers.volume->dim;
    const bool keeps_volumes = smooth->move == cwi_labels_smooth && !desc->leave_open;
    cwi_label_pressures pressures = {.moves = {.net = &j->net,
                                               .surfaces = j->out,
                                               .originals = j->originals,
                                               .dim = dim,
                                               .bound = (float)desc->max_move}};
    cwi_label_crossings crossings = {.mesh = mesh,
                                     .originals = j->originals,
                                     .net = &j->net,
                                     .to_point = index_to_point,
                                     .context = j};
    cwi_copy_large(j->originals, mesh->positions,
                   3 * mesh->vertex_count * sizeof *j->originals);
    pressures.moves.places = mesh->positions;
    cw_status st = cwi_label_net_finish(&j->net, mesh) &&
                           (!keeps_volumes || cwi_label_pressures_init(&pressures))
                       ? CW_OK
                       : cwi_fail_memory(err);
    if (st == CW_OK)
        st = smooth->move(keeps_volumes ? &pressures : smooth->context, &j->net, j->originals,
                          j->places, j->out, desc, dim, err);
    cwi_free(j->net.neighbours);
    j->net.neighbours = NULL;
    mesh->positions = j->places;
    j->places = pressures.moves.places;
    if (st == CW_OK && keeps_volumes)
        st = cwi_label_pressures_keep_first(&pressures, desc, err);
    if (st == CW_OK)
        st = place_all(j, desc, err);
    if (st == CW_OK)
        st =
            cwi_labels_untangle(&crossings, mesh, keeps_volumes ? &pressures : NULL, desc, err);
    cwi_label_pressures_free(&pressures);
    cwi_label_crossings_free(&crossings);
    return st;
}

/* Makes the surfaces that the first pass counted. */
static cw_status make_surfaces(cwi_label_job *j, size_t chunks, const cw_labels_desc *desc,
                               const cwi_label_smoother *smooth, cw_error *err)
{
    cw_status st = ensure_capacity(j, desc, err);
    j->is_writing = true;
    if (st == CW_OK)
        st = run_pass(j, chunks, desc, err);
    if (j->window)
        cwi_label_window_close(j->window);
    if (st == CW_OK)
        st = j->originals ? smooth_all(j, desc, smooth, err) : place_all(j, desc, err);
    return st;
}

static cw_status run_job(cwi_label_job *j, const cw_labels_desc *desc,
                         const cwi_label_smoother *smooth, cw_error *err)
{
    const size_t layers = j->layers.count - 1,
                 chunks = (layers + CWI_LABEL_CHUNK - 1) / CWI_LABEL_CHUNK;
    j->chunks = cwi_alloc_zeroed(chunks, sizeof *j->chunks);
    if (!j->chunks)
        return cwi_fail_memory(err);
    cw_status st = run_pass(j, chunks, desc, err);
    if (st == CW_OK)
        st = list_labels(j, chunks, err);
    if (st == CW_OK)
        st = list_patches(j, chunks, err);
    if (st == CW_OK)
        st = number_vertices(j, chunks, err);
    if (st == CW_OK && j->prediction)
        predict_job(j, desc);
    else if (st == CW_OK)
        st = make_surfaces(j, chunks, desc, smooth, err);
    cwi_label_net_free(&j->net);
    cwi_free(j->originals);
    cwi_free(j->places);
    for (size_t c = 0; c < chunks; c++) {
        cwi_key_counts_free(&j->chunks[c].pairs);
        cwi_key_counts_free(&j->chunks[c].voxels);
    }
    cwi_free(j->chunks);
    return st;
}

static int compare_labels(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Fills in what follows from the volume and the options. wanted: room for the labels, sorted. */
static void prepare_job(cwi_label_job *j, const cw_volume *v, const cw_labels_desc *desc,
                        uint32_t *requested)
{
    if (desc->label_count > 0)
        memcpy(requested, desc->labels, desc->label_count * sizeof *requested);
    qsort(requested, desc->label_count, sizeof *requested, compare_labels);
    j->layers = (cwi_label_layers){.volume = v,
                                   .background = desc->background,
                                   .copies_border = desc->leave_open,
                                   .width = v->dim[0] + 2,
                                   .height = v->dim[1] + 2,
                                   .count = v->dim[2] + 2,
                                   .requested_count = desc->label_count,
                                   .requested = requested};
    pthread_mutex_init(&j->bad_lock, NULL);
    cwi_label_rules_make(&j->rules);
    j->is_mirrored = cwi_affine_determinant(v->affine[0]) < 0;
    for (int t = 0; t < CWI_TETS; t++)
        for (int a = 0; a < 3; a++) {
            double sum = 0;
            for (int c = 0; c < 8; c++)
                sum += j->rules.tets[t] >> c & 1 ? (c >> a & 1) - 0.5 : 0;
            j->corners[t][a] = NEAR_FRACTION * sum / 4;
        }
}

/* Returns the maximum error of a point of the mesh along an axis of the grid, in voxels, from
 * rounding to single precision. */
static double find_rounding(const cw_volume *v)
{
    double cofactors[3][3], extent = 0, max = 0;
    const double volume = fabs(cwi_affine_determinant(v->affine[0]));
    cwi_affine_cofactor(v->affine[0], cofactors);
    for (int b = 0; b < 3; b++) {
        double half = 0; /* of the volume and its border */
        for (int a = 0; a < 3; a++)
            half += fabs(v->affine[b][a]) * 0.5 *
                    (find_coordinate(v, a, (double)v->dim[a]) - find_coordinate(v, a, -1));
        extent += half * half;
    }
    for (int a = 0; a < 3; a++) {
        double spacing = INFINITY, slope = 0;
        for (size_t i = 0; i < v->dim[a]; i++)
            spacing = fmin(spacing, find_coordinate(v, a, (double)i + 1) -
                                        find_coordinate(v, a, (double)i));
        for (int b = 0; b < 3; b++)
            slope += cofactors[b][a] * cofactors[b][a];
        max = fmax(max, sqrt(extent * slope) / (volume * spacing));
    }
    return 0x1p-24 * max;
}

/* Returns how far vertices may move, so that they stay inside of their cubes: those of two cubes
 * never meet. */
static double resolve_max_move(const cw_volume *v, double max_move)
{
    const double margin = fmax(MARGIN, 4 * find_rounding(v));
    return fmax(0, (max_move > 0 ? max_move : 0.5) - margin);
}

/* Extracts the labels of a resolved volume: of its voxels or, if there is a window, of slices.
 * prediction: NULL, or filled in; then surfaces are not made */
static cw_status extract_resolved(const cw_volume *v, cwi_label_window *window,
                                  const cw_labels_desc *desc, const cwi_label_smoother *smooth,
                                  cw_label_prediction *prediction, cw_label_surfaces *surfaces,
                                  cw_error *err)
{
    cw_status st = CW_OK;
    if (!(desc->max_move >= 0 && desc->max_move <= 0.5))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "vertices move by %g voxels: 0 to 0.5 was expected", desc->max_move);
    if (desc->label_count > 0 && !desc->labels)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%zu labels are wanted, but none are named",
                        desc->label_count);
    cw_labels_desc resolved = *desc;
    resolved.max_move = resolve_max_move(v, desc->max_move);
    uint32_t *requested = cwi_alloc_array(desc->label_count, sizeof *requested);
    cwi_label_job *j = cwi_alloc_zeroed(1, sizeof *j);
    if (requested && j) {
        j->out = surfaces;
        j->prediction = prediction;
        surfaces->background = desc->background;
        j->window = window;
        prepare_job(j, v, desc, requested);
        st = run_job(j, &resolved, smooth, err);
    } else
        st = cwi_fail_memory(err);
    cwi_free(j);
    cwi_free(requested);
    if (st != CW_OK || prediction)
        cw_label_surfaces_free(surfaces);
    return st;
}

/* Extracts or predicts the labels of a volume. */
static cw_status extract_volume(const cw_volume *volume, const cw_labels_desc *desc,
                                const cwi_label_smoother *smooth,
                                cw_label_prediction *prediction, cw_label_surfaces *surfaces,
                                cw_error *err)
{
    const cw_labels_desc none = {0};
    cw_volume v;
    memset(surfaces, 0, sizeof *surfaces);
    cw_status st = cw_volume_resolve(volume, &v, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&v, "extracting labels", err);
    return st == CW_OK ? extract_resolved(&v, NULL, desc ? desc : &none, smooth, prediction,
                                          surfaces, err)
                       : st;
}

/* Extracts or predicts the labels of a source. */
static cw_status extract_source(const cw_slice_source *source, size_t chunks,
                                const cw_labels_desc *desc, cw_label_prediction *prediction,
                                cw_label_surfaces *surfaces, cw_error *err)
{
    const cw_labels_desc none = {0};
    cwi_label_window w;
    memset(surfaces, 0, sizeof *surfaces);
    cw_status st = cwi_label_window_open(&w, source, chunks, err);
    if (st == CW_OK)
        st = extract_resolved(&w.whole, &w, desc ? desc : &none, &averages, prediction,
                              surfaces, err);
    cwi_label_window_close(&w);
    return st;
}

cw_status cwi_extract_labels_with(const cw_volume *volume, const cw_labels_desc *desc,
                                  const cwi_label_smoother *smooth, cw_label_surfaces *surfaces,
                                  cw_error *err)
{
    return extract_volume(volume, desc, smooth, NULL, surfaces, err);
}

cw_status cwi_extract_labels_windowed(const cw_slice_source *source, size_t chunks,
                                      const cw_labels_desc *desc, cw_label_surfaces *surfaces,
                                      cw_error *err)
{
    return extract_source(source, chunks, desc, NULL, surfaces, err);
}

cw_status cw_extract_labels_stream(const cw_slice_source *source, const cw_labels_desc *desc,
                                   cw_label_surfaces *surfaces, cw_error *err)
{
    CWI_REQUIRE(err, source, surfaces);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return cwi_extract_labels_windowed(source, 0, desc, surfaces, err);
}

cw_status cw_extract_labels(const cw_volume *volume, const cw_labels_desc *desc,
                            cw_label_surfaces *surfaces, cw_error *err)
{
    CWI_REQUIRE(err, volume, surfaces);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return cwi_extract_labels_with(volume, desc, &averages, surfaces, err);
}

cw_status cw_extract_labels_predict(const cw_volume *volume, const cw_labels_desc *desc,
                                    cw_label_prediction *prediction, cw_error *err)
{
    cw_label_surfaces none;
    CWI_REQUIRE(err, volume, prediction);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return extract_volume(volume, desc, NULL, prediction, &none, err);
}

cw_status cw_extract_labels_stream_predict(const cw_slice_source *source,
                                           const cw_labels_desc *desc,
                                           cw_label_prediction *prediction, cw_error *err)
{
    cw_label_surfaces none;
    CWI_REQUIRE(err, source, prediction);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return extract_source(source, 0, desc, prediction, &none, err);
}
