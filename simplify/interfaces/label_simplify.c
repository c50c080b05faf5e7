/* Implements cw_label_simplify(): checks the surfaces, runs passes of collapses until the error
 * is kept, and copies the result. */
#include <cubewright/labels.h>

#include "simplify/interfaces/label_collapse.h"
#include "simplify/interfaces/patch_distance.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"

#include <math.h>
#include <string.h>

/* Passes after which failing places are no longer tightened by steps, but stay as they are. */
enum { GENTLE_PASSES = 4 };

/* ---- checks ----------------------------------------------------------------------------- */

static cw_status check_desc(const cw_label_simplify_desc *d, cw_error *err)
{
    if (!d || (d->error_mm == 0 && d->triangles == 0 && d->ratio == 0))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "simplification has no target; error_mm, triangles or ratio was "
                        "expected");
    if (!(d->error_mm >= 0) || !isfinite(d->error_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "error_mm is %g; a finite distance of 0 or more was expected",
                        d->error_mm);
    if (!(d->ratio >= 0 && d->ratio < 1))
        return cwi_fail(err, CW_ERR_ARGUMENT, "ratio is %g; 0 to 1 was expected", d->ratio);
    return CW_OK;
}

static cw_status check_patches(const cw_label_surfaces *s, cw_error *err)
{
    size_t next = 0;
    for (size_t p = 0; p < s->patch_count; p++) {
        const cw_label_patch *patch = &s->patches[p];
        if (patch->first != next || patch->count > s->mesh.triangle_count - next)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "patch %zu has triangles %zu to %zu; from %zu and at most %zu of "
                            "them were expected",
                            p, patch->first, patch->first + patch->count, next,
                            s->mesh.triangle_count - next);
        next += patch->count;
    }
    if (next != s->mesh.triangle_count)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "patches have %zu triangles; the mesh has %zu, and each must be in one",
                        next, s->mesh.triangle_count);
    return CW_OK;
}

static cw_status check_surfaces(const cw_label_surfaces *s, cw_error *err)
{
    cw_status st = cwi_mesh_check_size(&s->mesh, "simplified", err);
    if (st == CW_OK)
        st = check_patches(s, err);
    for (size_t t = 0; t < s->mesh.triangle_count && st == CW_OK; t++) {
        const uint32_t *v = s->mesh.triangles + 3 * t;
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
            st = cwi_fail(err, CW_ERR_ARGUMENT,
                          "triangle %zu names a vertex twice; three vertices were expected", t);
    }
    return st;
}

/* Returns a power of two that makes the mesh about 1 wide, so that no product of lengths leaves
 * the range. */
static double find_scale(const cw_mesh *m)
{
    double widest = 0;
    int exponent;
    for (size_t a = 0; a < 3 && m->vertex_count > 0; a++) {
        float low = m->positions[a], high = low;
        for (size_t v = 1; v < m->vertex_count; v++) {
            const float x = m->positions[3 * v + a];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        widest = fmax(widest, (double)high - (double)low);
    }
    frexp(widest, &exponent);
    return widest > 0 ? ldexp(1, -exponent) : 1;
}

static size_t find_target(const cw_label_simplify_desc *d, size_t triangles)
{
    const double ratio = ceil(d->ratio * (double)triangles);
    return d->triangles > 0 && (double)d->triangles > ratio ? d->triangles : (size_t)ratio;
}

/* ---- results ---------------------------------------------------------------------------- */

/* Numbers the vertices that are left, and returns how many there are. */
static size_t number_vertices(const cwi_complex *c, uint32_t *numbers)
{
    size_t count = 0;
    for (size_t v = 0; v < c->vertex_count; v++)
        numbers[v] = c->heads[v] != CWI_NO_INDEX ? (uint32_t)count++ : CWI_NO_INDEX;
    return count;
}

/* Copies what is left of the complex, with the patches of the input. */
static void copy_complex(const cwi_complex *c, const uint32_t *numbers, double scale,
                         const cw_label_surfaces *in, cw_label_surfaces *out)
{
    size_t to = 0;
    for (size_t v = 0; v < c->vertex_count; v++)
        for (size_t k = 0; k < 3 && numbers[v] != CWI_NO_INDEX; k++)
            out->mesh.positions[3 * (size_t)numbers[v] + k] =
                (float)((double)c->points[3 * v + k] / scale);
    for (size_t p = 0; p < in->patch_count; p++) {
        const size_t end = in->patches[p].first + in->patches[p].count;
        out->patches[p] = in->patches[p];
        out->patches[p].first = to;
        for (size_t t = in->patches[p].first; t < end; t++) {
            if (c->corners[3 * t] == CWI_NO_INDEX)
                continue;
            for (size_t k = 0; k < 3; k++)
                out->mesh.triangles[3 * to + k] = numbers[c->corners[3 * t + k]];
            to++;
        }
        out->patches[p].count = to - out->patches[p].first;
    }
}

/* Makes the result; `out` is filled or emptied. */
static cw_status make_result(const cwi_complex *c, double scale, const cw_label_surfaces *in,
                             cw_label_surfaces *out, cw_error *err)
{
    memset(out, 0, sizeof *out);
    uint32_t *numbers = cwi_alloc_array(c->vertex_count, sizeof *numbers);
    out->patches = cwi_alloc_array(in->patch_count, sizeof *out->patches);
    out->labels = cwi_alloc_array(in->label_count, sizeof *out->labels);
    cw_status st = numbers && out->patches && out->labels ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_mesh_alloc(&out->mesh, number_vertices(c, numbers), c->live, false, err);
    if (st == CW_OK) {
        memcpy(out->mesh.origin, in->mesh.origin, sizeof out->mesh.origin);
        memcpy(out->mesh.affine, in->mesh.affine, sizeof out->mesh.affine);
        out->background = in->background;
        out->patch_count = in->patch_count;
        out->label_count = in->label_count;
        if (in->label_count > 0)
            memcpy(out->labels, in->labels, in->label_count * sizeof *out->labels);
        copy_complex(c, numbers, scale, in, out);
    }
    cwi_free(numbers);
    if (st != CW_OK)
        cw_label_surfaces_free(out);
    return st;
}

/* ---- the promise ------------------------------------------------------------------------ */

/* A job: the surfaces, and where they need a tighter error than in the pass before. */
typedef struct job {
    const cw_label_surfaces *in;
    const cw_label_simplify_desc *desc;
    double scale;
    size_t target, passes;
    cwi_complex complex;
    cwi_label_samples samples;
    bool *is_failing; /* one a sample */
} job;

static void fail_list(job *j, uint32_t triangle)
{
    for (uint32_t n = j->samples.heads[triangle]; n != CWI_NO_INDEX; n = j->samples.next[n])
        j->is_failing[n] = true;
}

/* Marks the samples in the list of a triangle of the complex. If there are none, marks those of
 * triangles of its patch around it. */
static void fail_around(job *j, size_t triangle)
{
    const cwi_complex *c = &j->complex;
    if (j->samples.heads[triangle] != CWI_NO_INDEX) {
        fail_list(j, (uint32_t)triangle);
        return;
    }
    for (size_t k = 0; k < 3; k++)
        for (uint32_t at = c->heads[c->corners[3 * triangle + k]]; at != CWI_NO_INDEX;
             at = c->next[at])
            if (c->patches[at / 3] == c->patches[triangle])
                fail_list(j, at / 3);
}

/* Marks the samples of the corners of a triangle of the input. */
static void fail_corners(job *j, size_t triangle)
{
    const cwi_label_samples *s = &j->samples;
    for (size_t k = 0; k < 3; k++) {
        const uint32_t v = j->in->mesh.triangles[3 * triangle + k];
        for (uint32_t n = s->first_sample[v]; n < s->first_sample[v + 1]; n++)
            j->is_failing[n] |= s->patches[n] == j->complex.patches[triangle];
    }
}

/* Tightens the error at marked samples. Returns true if any was raised. */
static bool raise_levels(job *j)
{
    bool is_any = false;
    for (size_t n = 0; n < j->samples.count; n++) {
        uint8_t *level = &j->samples.tighten_levels[n];
        if (!j->is_failing[n] || *level >= CWI_LABEL_MAX_TIGHTENING)
            continue;
        *level = j->passes < GENTLE_PASSES ? (uint8_t)(*level + 1) : CWI_LABEL_MAX_TIGHTENING;
        is_any = true;
    }
    return is_any;
}

/* Tightens the error where it was exceeded. If that changes nothing, all
 * samples get the last level, and the surfaces stay as they are.
 * in_beyond, out_beyond  of each triangle of the input and of the result: 1 if it is beyond */
static void tighten_beyond(job *j, const uint8_t *in_beyond, const uint8_t *out_beyond)
{
    const cwi_complex *c = &j->complex;
    memset(j->is_failing, 0, j->samples.count * sizeof *j->is_failing);
    for (size_t t = 0, of_out = 0; t < c->triangle_count; t++) {
        if (in_beyond[t])
            fail_corners(j, t);
        if (c->corners[3 * t] != CWI_NO_INDEX && out_beyond[of_out++])
            fail_around(j, t);
    }
    if (!raise_levels(j)) {
        memset(j->is_failing, 1, j->samples.count * sizeof *j->is_failing);
        j->passes = GENTLE_PASSES;
        (void)raise_levels(j);
    }
}

/* Measures a result. Sets *is_kept if it is within the error everywhere; else tightens it. */
static cw_status judge_result(job *j, const cw_label_surfaces *out, bool *is_kept,
                              cw_error *err)
{
    const size_t before = j->in->mesh.triangle_count, after = out->mesh.triangle_count;
    uint8_t *in_beyond = cwi_alloc_array(before, 1), *out_beyond = cwi_alloc_array(after, 1);
    cw_status st = in_beyond && out_beyond
                       ? cwi_patches_measure(j->in, out, j->desc->error_mm, j->desc->threads,
                                             &j->desc->progress, in_beyond, out_beyond, err)
                       : cwi_fail_memory(err);
    if (st == CW_OK) {
        *is_kept = !memchr(in_beyond, 1, before) && !memchr(out_beyond, 1, after);
        if (!*is_kept)
            tighten_beyond(j, in_beyond, out_beyond);
    }
    cwi_free(in_beyond);
    cwi_free(out_beyond);
    return st;
}

/* Makes the samples of the first pass, or takes those of the pass before. */
static cw_status prepare_samples(job *j, cw_error *err)
{
    if (!j->is_failing) {
        const cw_status st = cwi_label_samples_build(
            &j->samples, &j->complex, j->in->mesh.triangles, j->desc->error_mm * j->scale, err);
        if (st != CW_OK)
            return st;
        j->is_failing = cwi_alloc_array(j->samples.count, sizeof *j->is_failing);
        if (!j->is_failing)
            return cwi_fail_memory(err);
    }
    cwi_label_samples_restart(&j->samples, &j->complex);
    return CW_OK;
}

/* Simplifies once. Sets *is_kept if the result is near enough; else the next pass is tighter. */
static cw_status run_pass(job *j, cw_label_surfaces *out, bool *is_kept, cw_error *err)
{
    const bool has_error = j->desc->error_mm > 0;
    j->passes++;
    *is_kept = true;
    cw_status st = cwi_complex_build(&j->complex, j->in, j->scale, err);
    if (st == CW_OK && has_error)
        st = prepare_samples(j, err);
    if (st == CW_OK)
        st = cwi_label_collapse(&j->complex, has_error ? &j->samples : NULL, j->target,
                                &j->desc->progress, err);
    if (st == CW_OK)
        st = make_result(&j->complex, j->scale, j->in, out, err);
    if (st == CW_OK && has_error) {
        st = judge_result(j, out, is_kept, err);
        if (st != CW_OK || !*is_kept)
            cw_label_surfaces_free(out);
    }
    cwi_complex_free(&j->complex);
    return st;
}

cw_status cw_label_simplify(const cw_label_surfaces *in, const cw_label_simplify_desc *desc,
                            cw_label_surfaces *out, cw_error *err)
{
    CWI_REQUIRE(err, in, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    memset(out, 0, sizeof *out);
    cw_status st = check_desc(desc, err);
    if (st == CW_OK)
        st = check_surfaces(in, err);
    if (st != CW_OK)
        return st;
    job j = {.in = in,
             .desc = desc,
             .scale = find_scale(&in->mesh),
             .target = find_target(desc, in->mesh.triangle_count)};
    bool is_kept = false;
    while (st == CW_OK && !is_kept)
        st = run_pass(&j, out, &is_kept, err);
    cwi_label_samples_free(&j.samples);
    cwi_free(j.is_failing);
    return st;
}
