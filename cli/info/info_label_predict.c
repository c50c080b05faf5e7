/* Counts the surfaces that `extract --labels` would make, and predicts their memory and time. */
#include "cli/info/info_label_predict.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/info/info_predict.h"
#include "cli/inputs/label_choice.h"
#include "cli/inputs/label_scene.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <cubewright/field.h>
#include <cubewright/quality.h>

#include <math.h>
#include <stdlib.h>

/* The facts that predictions of all components share. */
typedef struct predictor {
    const cli_label_predict_desc *desc;
    cli_volume *volume;
    cli_label_choice choice;
    double count_seconds; /* of this volume */
    double surface_rate;  /* seconds for a triangle of the interfaces, and */
    double mesh_rate;     /* for one of a label's own mesh: made and checked */
    cli_label_prediction *out;
} predictor;

/* Returns the bytes of surfaces: those that extraction takes, or later the interfaces and all labels'
 * own meshes with normals. A closed mesh has about half as many vertices as triangles. */
static double surface_bytes(const cw_label_prediction *counts)
{
    enum { POSITION = 12, VERTEX = 24, TRIANGLE = 12 };
    const double kept = POSITION * (double)counts->vertices +
                        TRIANGLE * (double)counts->triangles +
                        (TRIANGLE + VERTEX / 2) * (double)counts->own_triangles;
    return fmax(kept, (double)counts->bytes);
}

/* --- time --------------------------------------------------------------------------------- */

/* Makes and checks the mesh of each label. */
static cw_status check_labels(const cw_label_surfaces *s, int threads, cw_error *err)
{
    const cw_quality_desc check = {.threads = threads};
    cw_status st = CW_OK;
    for (size_t n = 0; n < s->label_count && st == CW_OK; n++) {
        cw_mesh mesh;
        cw_quality quality;
        st = cw_label_mesh(s, s->labels[n].label, &mesh, err);
        if (st == CW_OK)
            st = cw_quality_measure(&mesh, &check, &quality, err);
        cw_mesh_free(&mesh);
    }
    return st;
}

/* Times the work on a triangle: the cells of a small label map are extracted and checked. Little memory
 * allows only a smaller one, which the caches make faster. */
static cw_status time_triangles(predictor *p, cw_error *err)
{
    enum { EDGE = 96, SMALL_EDGE = 40, LABELS = 300, SMALL_LABELS = 20, LITTLE = 256 << 20 };
    const bool is_little = cwi_memory_left() < LITTLE;
    const size_t edge = is_little ? SMALL_EDGE : EDGE;
    const int threads = (int)p->desc->input->threads;
    const cw_label_field_desc field = {.dim = {edge, edge, edge},
                                       .type = CW_U16,
                                       .labels = is_little ? SMALL_LABELS : LABELS,
                                       .threads = threads};
    const cw_labels_desc desc = {.threads = threads};
    cw_volume volume = {0};
    cw_label_surfaces surfaces = {0};
    cw_label_prediction counts = {0};
    double start = 0, counted = 0, made = 0;
    cw_status st = cw_label_field_sample(&field, &volume, err);
    start = cli_seconds();
    if (st == CW_OK)
        st = cw_extract_labels_predict(&volume, &desc, &counts, err);
    counted = cli_seconds();
    if (st == CW_OK)
        st = cw_extract_labels(&volume, &desc, &surfaces, err);
    made = cli_seconds();
    if (st == CW_OK)
        st = check_labels(&surfaces, threads, err);
    if (st == CW_OK) {
        const double passes = 2 * (counted - start);
        p->surface_rate = (made - counted - passes) / (double)counts.triangles;
        p->mesh_rate = (cli_seconds() - made) / (double)counts.own_triangles;
    }
    cw_label_surfaces_free(&surfaces);
    cw_volume_free(&volume);
    return st;
}

/* --- counts ------------------------------------------------------------------------------- */

static void add_counts(cw_label_prediction *sum, const cw_label_prediction *counts)
{
    sum->labels += counts->labels;
    sum->patches += counts->patches;
    sum->vertices += counts->vertices;
    sum->triangles += counts->triangles;
    sum->own_triangles += counts->own_triangles;
    sum->bytes += counts->bytes;
}

/* A component whose slices are counted. */
typedef struct slice_count {
    const cw_labels_desc *desc;
    cw_label_prediction *counts;
} slice_count;

static cw_status count_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    const slice_count *s = user;
    return cw_extract_labels_stream_predict(source, s->desc, s->counts, err);
}

/* Counts the surfaces of one component, from its voxels or from slices. */
static cw_status count_component(predictor *p, uint32_t number, const cw_labels_desc *desc,
                                 cw_label_prediction *counts, cw_error *err)
{
    cli_input input = *p->desc->input;
    slice_count slices = {desc, counts};
    const cw_slice_visitor visitor = {count_slices, &slices};
    cw_volume view;
    input.of_labels = true;
    input.array.component.number = number;
    if (p->volume->streams)
        return cli_visit_slices(p->volume, &input, &visitor, err);
    const cw_status st = cw_volume_select(&p->volume->voxels, number, input.step, &view, err);
    return st == CW_OK ? cw_extract_labels_predict(&view, desc, counts, err) : st;
}

static cw_status count_layer(predictor *p, uint32_t number, cw_error *err)
{
    const cw_volume *v = &p->volume->view;
    const double voxels = (double)v->dim[0] * (double)v->dim[1] * (double)v->dim[2];
    cw_label_prediction counts = {0};
    uint32_t *values = NULL;
    size_t count = 0;
    cw_status st = CW_OK;
    if (!p->choice.all)
        st = cli_labels_of_layer(&p->choice, number, &values, &count, err);
    if (st == CW_OK && (p->choice.all || count > 0)) {
        const cw_labels_desc desc = {.labels = values,
                                     .label_count = count,
                                     .threads = (int)p->desc->input->threads,
                                     .progress = cli_progress(voxels / 1e6, "Mvoxel")};
        st = count_component(p, number, &desc, &counts, err);
    }
    free(values);
    add_counts(&p->out->counts, &counts);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, p->volume->path);
}

static void predict_cost(const predictor *p)
{
    enum { SLICES = 32 << 20 };
    cli_label_prediction *out = p->out;
    const cw_label_prediction *counts = &out->counts;
    const cw_volume *v = &p->volume->view;
    const double voxels = (double)v->dim[0] * (double)v->dim[1] * (double)v->dim[2] *
                          (double)v->components * (double)cw_type_size(v->type);
    out->is_streamed = p->volume->streams;
    out->stl_bytes = cli_stl_bytes(counts->own_triangles);
    out->memory_bytes =
        (size_t)((double)p->desc->program_bytes + (p->volume->streams ? SLICES : voxels) +
                 surface_bytes(counts));
    out->is_beyond = out->memory_bytes > cli_memory_limit(p->desc->input);
    out->seconds = p->desc->read_seconds + 2 * p->count_seconds +
                   p->surface_rate * (double)counts->triangles +
                   p->mesh_rate * (double)counts->own_triangles;
}

/* Counts the surfaces of all components that hold labels. */
static cw_status count_layers(predictor *p, cw_error *err)
{
    size_t first, end;
    cw_status st = cli_choose_labels("--labels", p->desc->list, p->desc->table, &p->volume->ids,
                                     &p->choice, err);
    const double start = cli_seconds();
    cli_label_layers(p->volume, p->desc->input, &first, &end);
    for (size_t n = first; n < end && st == CW_OK; n++)
        st = count_layer(p, (uint32_t)n, err);
    p->count_seconds = cli_seconds() - start;
    cli_free_label_choice(&p->choice);
    if (st == CW_OK && p->out->counts.labels == 0)
        st = cwi_fail(err, CW_ERR_EMPTY, "%s: no voxel has one of the labels of --labels",
                      p->volume->path);
    return st;
}

/* Counts the surfaces of a volume whose voxels are not all in memory. */
static cw_status count_again(const predictor *of_part, cw_error *err)
{
    predictor p = *of_part;
    cli_label_predict_desc desc = *p.desc;
    cli_volume all;
    cli_input input = *desc.input;
    input.is_quiet = true;
    input.sample = false;
    input.of_labels = true;
    input.may_stream = true;
    input.array.component.given = true; /* all are taken, unless one was stated */
    const double start = cli_seconds();
    cw_status st = cli_read_volume(p.volume->path, &input, false, &all, err);
    desc.read_seconds = cli_seconds() - start;
    desc.input = &input;
    p.desc = &desc;
    p.volume = &all;
    *p.out = (cli_label_prediction){.list = desc.list};
    if (st == CW_OK)
        st = count_layers(&p, err);
    if (st == CW_OK)
        predict_cost(&p);
    cli_free_volume(&all);
    return st;
}

cw_status cli_predict_labels(const cli_label_predict_desc *desc, cli_volume *volume,
                             cli_label_prediction *out, cw_error *err)
{
    predictor p = {.desc = desc, .volume = volume, .out = out};
    *out = (cli_label_prediction){.list = desc->list};
    if (volume->whole.sparse || volume->whole.cells)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "%s: --labels is for dense grids of voxels; this is %s", volume->path,
                        cwi_volume_kind(&volume->whole));
    cw_status st = time_triangles(&p, err);
    const bool is_part = cli_is_preview(volume);
    if (st == CW_OK && !is_part)
        st = count_layers(&p, err);
    if (is_part ? st == CW_OK : st == CW_ERR_NO_MEMORY) {
        cw_volume_free(&volume->voxels);
        volume->view.data = NULL;
        return count_again(&p, err);
    }
    if (st == CW_OK)
        predict_cost(&p);
    return st;
}

/* --- output ------------------------------------------------------------------------------- */

void cli_print_label_prediction(const cli_label_prediction *p)
{
    if (!p->list)
        return;
    printf("  extract  --labels %s: %s label%s, %s triangles; %s with --shared-faces\n",
           p->list, cli_count(p->counts.labels), p->counts.labels == 1 ? "" : "s",
           cli_count(p->counts.own_triangles), cli_count(p->counts.triangles));
    printf("    file     STL %s\n", cli_bytes((double)p->stl_bytes));
    printf("    memory   about %s%s%s\n", cli_bytes((double)p->memory_bytes),
           p->is_streamed ? ", with voxels slice by slice" : "",
           p->is_beyond ? "; as --memory is less, surfaces go to temporary files" : "");
    printf("    time     about %.*f s, and writing\n", p->seconds < 10 ? 1 : 0, p->seconds);
}

void cli_json_label_prediction(cli_json *j, const cli_label_prediction *p)
{
    if (!p->list)
        return;
    cli_json_open(j, "label_prediction", '{');
    cli_json_text(j, "list", p->list);
    cli_json_count(j, "labels", p->counts.labels);
    cli_json_count(j, "interfaces", p->counts.patches);
    cli_json_count(j, "triangles", p->counts.own_triangles);
    cli_json_count(j, "shared_triangles", p->counts.triangles);
    cli_json_count(j, "shared_vertices", p->counts.vertices);
    cli_json_count(j, "stl_bytes", p->stl_bytes);
    cli_json_count(j, "memory_bytes", p->memory_bytes);
    cli_json_bool(j, "streamed", p->is_streamed);
    cli_json_bool(j, "overflows", p->is_beyond);
    cli_json_number(j, "seconds", p->seconds);
    cli_json_close(j, '}');
}
