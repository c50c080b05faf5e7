/* Counts the surfaces that `extract` would make, and predicts the size of their files, memory and
 * time. */
#define _GNU_SOURCE /* PATH_MAX */
#include "cli/info/info_predict.h"

#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "cli/framework/quantity.h"
#include "cli/framework/temp_folder.h"
#include "cli/inputs/extract_surface.h"
#include "cli/inputs/synthetic_input.h"
#include "cli/inputs/volume_prepare.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/missing_values.h"
#include "core/volume/volume.h"

#include <cubewright/quality.h>
#include <cubewright/stream.h>

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The facts that predictions of all isovalues share. */
typedef struct predictor {
    const cli_input *input;
    cli_volume *volume;
    size_t program;                /* bytes of the process without voxels */
    double read_seconds;           /* time that reading the voxels took */
    double make_seconds;           /* for a triangle: made in memory */
    double check_seconds;          /* for a triangle: checked */
    char stem[CLI_STEM_TEXT];      /* of the volume's name, which headers hold */
    size_t ply_header, glb_header; /* bytes of files beside their arrays; 0: not written */
} predictor;

/* --- files -------------------------------------------------------------------------------- */

/* Bytes of the elements of files with normals. */
enum {
    PLY_VERTEX = 24,
    PLY_FACE = 13,
    GLB_VERTEX = 24,
    STL_HEADER = 84,
    STL_FACET = 50,
    MAX_SHORT_INDEX = UINT16_MAX /* vertices that glTF numbers by 16 bits */
};

static size_t count_digits(size_t n)
{
    size_t digits = 1;
    for (; n >= 10; n /= 10)
        digits++;
    return digits;
}

static size_t ply_bytes(size_t header, size_t vertices, size_t triangles)
{
    return header + count_digits(vertices) + count_digits(triangles) + PLY_VERTEX * vertices +
           PLY_FACE * triangles;
}

static size_t glb_arrays(size_t vertices, size_t triangles)
{
    return GLB_VERTEX * vertices + triangles * (vertices <= MAX_SHORT_INDEX ? 6 : 12);
}

/* Writes a tetrahedron, and returns the size of its file; 0: it was not written. */
static size_t write_sample(const char *folder, const char *name, const char *extension,
                           const cw_volume *volume)
{
    float points[4][3] = {
        {0.123456f, 0, 0}, {9.87654f, 0, 0}, {0, 7.65432f, 0}, {0, 0, 5.4321f}};
    float normals[4][3] = {{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    uint32_t corners[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    cw_mesh mesh = {.positions = points[0],
                    .normals = normals[0],
                    .triangles = corners[0],
                    .vertex_count = 4,
                    .triangle_count = 4};
    const cw_write_desc desc = {.name = name};
    char path[PATH_MAX];
    struct stat file;
    memcpy(mesh.affine, volume->affine, sizeof mesh.affine);
    snprintf(path, sizeof path, "%s/sample.%s", folder, extension);
    return cw_mesh_write(path, &mesh, &desc, NULL) == CW_OK && stat(path, &file) == 0
               ? (size_t)file.st_size
               : 0;
}

/* Finds the sizes of headers from files of a small mesh. */
static cw_status measure_headers(predictor *p, cw_error *err)
{
    char *folder, *name = cli_stem(p->volume->path);
    cw_status st = cli_scratch_make(&folder, err);
    if (st == CW_OK && !name)
        st = cwi_fail_memory(err);
    if (st == CW_OK) {
        snprintf(p->stem, sizeof p->stem, "%s", name);
        const size_t ply = write_sample(folder, name, "ply", &p->volume->whole),
                     glb = write_sample(folder, name, "glb", &p->volume->whole);
        p->ply_header = ply ? ply - ply_bytes(0, 4, 4) : 0;
        p->glb_header = glb ? glb - glb_arrays(4, 4) : 0;
        cli_scratch_remove(folder);
    }
    free(name);
    return st;
}

size_t cli_stl_bytes(size_t triangles)
{
    return STL_HEADER + STL_FACET * triangles;
}

static void predict_files(const predictor *p, cli_prediction *out)
{
    const size_t glb = p->glb_header + glb_arrays(out->vertices, out->triangles);
    memcpy(out->stem, p->stem, sizeof out->stem);
    out->ply_bytes = ply_bytes(p->ply_header, out->vertices, out->triangles);
    out->stl_bytes = cli_stl_bytes(out->triangles);
    out->glb_bytes = p->glb_header && glb <= UINT32_MAX ? glb : 0;
}

/* --- time --------------------------------------------------------------------------------- */

/* Times the work on a triangle: the surface of a small volume is made and checked. Little memory
 * allows only a smaller one, which the caches make faster. */
static cw_status time_triangles(predictor *p, cw_error *err)
{
    enum { EDGE = 128, SMALL_EDGE = 40, LITTLE = 256 << 20 };
    const size_t edge = cwi_memory_left() < LITTLE ? SMALL_EDGE : EDGE;
    const cw_extract_desc extract = {.threads = (int)p->input->threads};
    const cw_quality_desc check = {.threads = (int)p->input->threads};
    const cw_field_desc field = {.field = CW_FIELD_GYROID,
                                 .dim = {edge, edge, edge},
                                 .type = CW_F32,
                                 .threads = (int)p->input->threads};
    cw_volume volume = {0};
    cw_mesh mesh = {0};
    cw_quality quality;
    double start = 0, made = 0;
    cw_status st = cw_field_sample(&field, &volume, err);
    if (st == CW_OK) {
        start = cli_seconds();
        st = cw_extract(&volume, &extract, &mesh, NULL, err);
        made = cli_seconds();
    }
    if (st == CW_OK)
        st = cw_quality_measure(&mesh, &check, &quality, err);
    if (st == CW_OK) {
        p->make_seconds = (made - start) / (double)mesh.triangle_count;
        p->check_seconds = (cli_seconds() - made) / (double)mesh.triangle_count;
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
    return st;
}

/* --- counts ------------------------------------------------------------------------------- */

static cw_extract_desc describe_extract(const predictor *p, double iso)
{
    return (cw_extract_desc){.isovalue = iso,
                             .inside_is_low =
                                 cli_inside_is_low(CLI_INSIDE_AUTO, &p->volume->whole),
                             .threads = (int)p->input->threads};
}

static double voxel_count(const cw_volume *v)
{
    return (double)v->dim[0] * (double)v->dim[1] * (double)v->dim[2];
}

/* Bytes of the voxels as extract reads them, all components and steps, and of those that --resample
 * and --denoise make of them. */
static double voxel_bytes(const predictor *p)
{
    const cw_volume *v = &p->volume->whole, *made = &p->volume->prepared,
                    *shape = made->data ? &p->volume->voxels : &p->volume->view;
    const double read = voxel_count(shape) * (double)cw_type_size(v->type) *
                        (double)v->components * (double)v->steps;
    return made->data ? read + voxel_count(made) * (double)cw_type_size(made->type) : read;
}

static void predict_memory(const predictor *p, double beside, cli_prediction *out)
{
    const cw_stream_desc stream = {.extract = describe_extract(p, out->iso)};
    const double bytes =
        voxel_bytes(p) + beside + (double)cli_check_bytes() * (double)out->triangles;
    out->memory_bytes = (size_t)bytes;
    out->needs_all = cli_find_unstreamed_preparation(p->input);
    if (out->needs_all)
        return;
    cw_volume source = p->volume->view;
    source.type = p->volume->whole.type;
    out->slices_bytes = cli_slices_bytes(&p->volume->view, &stream, p->program) +
                        cli_slice_filter_bytes(p->input, &source);
    out->is_streamed = out->memory_bytes > cli_memory_limit(p->input);
}

static cw_status count_in_memory(const predictor *p, cli_prediction *out, cw_error *err)
{
    const cw_extract_desc desc = describe_extract(p, out->iso);
    const double start = cli_seconds();
    cw_extract_counts counts;
    cw_status st = cw_extract_predict(&p->volume->view, &desc, &counts, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, p->volume->path);
    out->vertices = counts.vertices;
    out->triangles = counts.triangles;
    out->seconds = p->read_seconds + cli_seconds() - start +
                   (p->make_seconds + p->check_seconds) * (double)counts.triangles;
    predict_memory(p, (double)p->program + (double)counts.bytes, out);
    return CW_OK;
}

static cw_status ignore_chunk(void *user, const cw_mesh_chunk *chunk, cw_error *err)
{
    (void)user;
    (void)chunk;
    (void)err;
    return CW_OK;
}

/* A surface that is made slice by slice, to be counted. */
typedef struct slice_count {
    const predictor *predictor;
    cli_prediction *out;
} slice_count;

static cw_status count_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    enum { VERTEX_BYTES = 24, TRIANGLE_BYTES = 12 };
    const slice_count *s = user;
    const predictor *p = s->predictor;
    const size_t limit = cli_memory_limit(p->input);
    const cli_slices slices = {.path = p->volume->path, .limit = limit, .turned = true};
    const double voxels = voxel_count(&source->shape), start = cli_seconds();
    cw_stream_desc desc = {.extract = describe_extract(p, s->out->iso)};
    cw_extract_counts counts;
    cw_status st = cli_limit_slices(&slices, &source->shape, &desc, err);
    desc.extract.progress = cli_progress(voxels / 1e6, "Mvoxel");
    if (st == CW_OK)
        st =
            cw_extract_stream(source, &desc, (cw_chunk_sink){ignore_chunk, NULL}, &counts, err);
    if (st != CW_OK)
        return st;
    s->out->vertices = counts.vertices;
    s->out->triangles = counts.triangles;
    s->out->seconds = cli_seconds() - start + p->check_seconds * (double)counts.triangles;
    predict_memory(p,
                   cli_bytes_beside(voxels, limit) + VERTEX_BYTES * (double)counts.vertices +
                       TRIANGLE_BYTES * (double)counts.triangles,
                   s->out);
    return CW_OK;
}

static cw_status predict_surface(const predictor *p, cli_prediction *out, cw_error *err)
{
    slice_count slices = {p, out};
    const cw_slice_visitor visitor = {count_slices, &slices};
    cw_status st = p->volume->streams ? cli_visit_slices(p->volume, p->input, &visitor, err)
                                      : count_in_memory(p, out, err);
    if (st == CW_OK)
        predict_files(p, out);
    return st;
}

/* --- the volume --------------------------------------------------------------------------- */

/* Frees what info has read. */
static void free_voxels(cli_volume *volume)
{
    cw_volume_free(&volume->magnitude);
    cw_volume_free(&volume->voxels);
    volume->view.data = NULL;
}

static cw_status predict_surfaces(const predictor *p, const cli_numbers *iso,
                                  cli_predictions *out, cw_error *err)
{
    cw_status st = CW_OK;
    for (out->count = 0; out->count < iso->count && st == CW_OK; out->count++) {
        out->items[out->count] = (cli_prediction){.iso = iso->value[out->count]};
        st = predict_surface(p, &out->items[out->count], err);
    }
    return st;
}

/* Predicts surfaces from all voxels of a volume of which info read a part. They are read as a whole,
 * or come in slices. */
static cw_status predict_again(const predictor *of_part, const cli_numbers *iso, bool in_slices,
                               cli_predictions *out, cw_error *err)
{
    predictor p = *of_part;
    cli_volume all;
    cli_input input = *p.input;
    input.is_quiet = true;
    input.sample = false;
    input.may_stream = in_slices;
    input.stream = in_slices ? CLI_STREAM_ALWAYS : CLI_STREAM_NEVER;
    const double start = cli_seconds();
    cw_status st = cli_read_volume(p.volume->path, &input, false, &all, err);
    p.read_seconds = cli_seconds() - start;
    p.volume = &all;
    if (st == CW_OK)
        st = predict_surfaces(&p, iso, out, err);
    cli_free_volume(&all);
    return st;
}

cw_status cli_predict(const cli_predict_desc *desc, cli_volume *volume, cli_predictions *out,
                      cw_error *err)
{
    predictor p = {.input = desc->input,
                   .volume = volume,
                   .program = desc->program_bytes,
                   .read_seconds = desc->read_seconds};
    if (volume->whole.sparse || volume->whole.cells)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "%s: what 'extract' takes is not predicted for %s (--iso); --levels "
                        "counts triangles",
                        volume->path, cwi_volume_kind(&volume->whole));
    cw_status st = measure_headers(&p, err);
    if (st == CW_OK)
        st = time_triangles(&p, err);
    const bool is_part = cli_is_preview(volume);
    if (st == CW_OK && !is_part)
        st = predict_surfaces(&p, desc->iso, out, err);
    if (is_part ? st == CW_OK : st == CW_ERR_LIMIT || st == CW_ERR_NO_MEMORY) {
        free_voxels(volume);
        st = p.input->array.component.magnitude ? CW_ERR_UNSUPPORTED
                                                : predict_again(&p, desc->iso, true, out, err);
        if (st == CW_ERR_UNSUPPORTED) /* in slices */
            st = predict_again(&p, desc->iso, false, out, err);
    }
    return st;
}

cw_status cli_expect_surfaces(const cli_volume *volume, const cli_predictions *p, cw_error *err)
{
    char missing[CWI_MISSING_TEXT];
    cwi_tell_missing(&volume->whole, NULL, missing);
    for (size_t n = 0; n < p->count; n++)
        if (!p->items[n].triangles)
            return cwi_fail(
                err, CW_ERR_EMPTY,
                "%s: no surface at isovalue %g%s: it must be above the lowest value and "
                "at most the highest",
                volume->path, p->items[n].iso, missing);
    return CW_OK;
}

/* --- output ------------------------------------------------------------------------------- */

void cli_print_predictions(const cli_predictions *p)
{
    for (size_t n = 0; n < p->count; n++) {
        const cli_prediction *m = &p->items[n];
        printf("  extract  --iso %s: ", cli_number_text(m->iso));
        if (!m->triangles) {
            puts("no surface");
            continue;
        }
        printf("%s triangles, %s vertices\n", cli_count(m->triangles), cli_count(m->vertices));
        printf("    file     PLY %s, STL %s", cli_bytes((double)m->ply_bytes),
               cli_bytes((double)m->stl_bytes));
        if (m->glb_bytes)
            printf(", GLB about %s", cli_bytes((double)m->glb_bytes));
        printf("\n    memory   about %s", cli_bytes((double)m->memory_bytes));
        if (m->needs_all)
            printf("; %s needs all voxels in memory\n", m->needs_all);
        else
            printf("; slice by slice at least %s%s\n", cli_bytes((double)m->slices_bytes),
                   m->is_streamed ? ", as --memory is less" : "");
        printf("    time     about %.*f s, and writing\n", m->seconds < 10 ? 1 : 0, m->seconds);
    }
}

void cli_json_predictions(cli_json *j, const cli_predictions *p)
{
    if (!p->count)
        return;
    cli_json_open(j, "predictions", '[');
    for (size_t n = 0; n < p->count; n++) {
        const cli_prediction *m = &p->items[n];
        cli_json_open(j, NULL, '{');
        cli_json_number(j, "iso", m->iso);
        cli_json_count(j, "triangles", m->triangles);
        cli_json_count(j, "vertices", m->vertices);
        if (m->triangles) {
            cli_json_text(j, "stem", m->stem);
            cli_json_count(j, "ply_bytes", m->ply_bytes);
            cli_json_count(j, "stl_bytes", m->stl_bytes);
            if (m->glb_bytes)
                cli_json_count(j, "glb_bytes", m->glb_bytes);
            cli_json_count(j, "memory_bytes", m->memory_bytes);
            if (!m->needs_all)
                cli_json_count(j, "slices_bytes", m->slices_bytes);
            cli_json_bool(j, "streamed", m->is_streamed);
            cli_json_number(j, "seconds", m->seconds);
        }
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}
