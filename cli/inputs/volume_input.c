/* Reads the volume that the options describe: memory limit, crop, coarsening, component and
 * step. */
#define _GNU_SOURCE /* sysconf names */
#include "cli/inputs/volume_input.h"

#include "cli/inputs/volume_prepare.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/framework/standard_streams.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/box.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Three quarters of what the machine, or the container around this process, has. */
static size_t default_memory(void)
{
    double bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    char line[64];
    FILE *limit = fopen("/sys/fs/cgroup/memory.max", "r");
    if (limit) {
        const char *text = fgets(line, sizeof line, limit);
        double value;
        if (text && cwi_parse_double(&text, &value) && value > 0 && value < bytes)
            bytes = value;
        fclose(limit);
    }
    return (size_t)(0.75 * bytes);
}

size_t cli_memory_limit(const cli_input *input)
{
    return input->memory ? input->memory : default_memory();
}

/* From the first corner of cells to the second, on average. */
static double mean_edge(const cw_cells *c)
{
    static const size_t corners_of[CW_SHAPE_COUNT] = {
        [CW_TETRAHEDRON] = 4, [CW_PYRAMID] = 5, [CW_WEDGE] = 6, [CW_HEXAHEDRON] = 8};
    const uint32_t *corner = c->corners;
    double sum = 0;
    for (size_t n = 0; n < c->count; corner += corners_of[c->shapes[n++]]) {
        const double *p = c->points + 3 * (size_t)corner[0],
                     *q = c->points + 3 * (size_t)corner[1];
        sum += hypot(hypot(q[0] - p[0], q[1] - p[1]), q[2] - p[2]);
    }
    return sum / (double)c->count;
}

/* Counts the cells by shape, again where samples were merged, and finds the box of their
 * points. */
static void find_grid(const cw_volume *v, cli_volume *volume)
{
    cli_grid *g = &volume->grid;
    const cw_cells *c = v->cells;
    *g = (cli_grid){.has_box = c->points != NULL};
    volume->whole.dim[0] = v->dim[0];
    for (size_t n = 0; n < c->count; n++)
        g->cells[c->shapes[n]]++;
    for (size_t n = 0; c->points && n < 3 * v->dim[0]; n++) {
        const double x = c->points[n];
        g->low[n % 3] = n < 3 ? x : fmin(g->low[n % 3], x);
        g->high[n % 3] = n < 3 ? x : fmax(g->high[n % 3], x);
    }
    for (int a = 0; a < 3 && c->points; a++)
        volume->spacing[a] = mean_edge(c);
}

static cw_status check_choice(const cli_input *input, const cw_volume *v, cw_error *err)
{
    const cli_component *c = &input->array.component;
    if (c->magnitude && v->components < 2)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--component mag needs vectors; the volume has one value a voxel");
    if (!c->magnitude && c->number >= v->components)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--component %zu: the volume has %zu, counted from 0", c->number,
                        v->components);
    if (input->step >= v->steps)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--step %zu: the volume has %zu, counted from 0",
                        input->step, v->steps);
    return CW_OK;
}

/* The voxels between the ends of a range, as far as there are any. */
static bool clip_range(double low, double high, size_t size, size_t *first, size_t *count)
{
    low = fmax(ceil(low - 1e-9), 0);
    high = fmin(floor(high + 1e-9), (double)(size - 1));
    if (!(low <= high))
        return false;
    *first = (size_t)low;
    *count = (size_t)(high - low) + 1;
    return true;
}

/* The box of indices around a box of the world. */
static cw_status box_from_world(const cw_volume *v, cli_ranges *r, cw_error *err)
{
    double low[3], high[3];
    cwi_box_clear(low, high);
    for (int corner = 0; corner < 8; corner++) {
        double world[3], index[3];
        for (int a = 0; a < 3; a++)
            world[a] = corner >> a & 1 ? r->high[a] : r->low[a];
        cw_status st = cw_volume_to_index(v, world, index, err);
        if (st != CW_OK)
            return st;
        cwi_box_add(low, high, index);
    }
    memcpy(r->low, low, sizeof low);
    memcpy(r->high, high, sizeof high);
    return CW_OK;
}

/* The voxels that --crop asks for, as far as there are any. */
static cw_status find_box(const cli_input *input, const cw_volume *v, bool is_quiet,
                          cw_box *box, cw_error *err)
{
    cli_ranges r = input->crop;
    cw_status st = r.world ? box_from_world(v, &r, err) : CW_OK;
    for (int a = 0; st == CW_OK && a < 3; a++) {
        const size_t size = v->dim[a];
        if (!clip_range(r.low[a], r.high[a], size, &box->first[a], &box->count[a]))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--crop leaves no voxel along %c: the volume has voxels 0 to %zu; "
                            "%.6g to %.6g were requested",
                            "xyz"[a], size - 1, r.low[a], r.high[a]);
    }
    if (st == CW_OK && !is_quiet)
        cli_say("using voxels %zu:%zu,%zu:%zu,%zu:%zu", box->first[0],
                box->first[0] + box->count[0] - 1, box->first[1],
                box->first[1] + box->count[1] - 1, box->first[2],
                box->first[2] + box->count[2] - 1);
    return st;
}

static size_t pick_coarsening(const cli_input *input)
{
    return input->coarsen ? input->coarsen : input->preview ? 4 : 1;
}

/* Chooses to keep one voxel in `asked` along each axis; a thin axis keeps its first
 * and last. */
static void choose_coarsening(size_t requested, const cw_volume *part, size_t step[3])
{
    for (int a = 0; a < 3; a++)
        step[a] = requested < part->dim[a] ? requested
                  : part->dim[a] > 2       ? part->dim[a] - 1
                                           : 1;
}

/* Chooses rows and slices that take 256 MiB, or half of the limit, at most. */
static void choose_sample(const cw_volume *part, size_t limit, size_t step[3])
{
    const double max_bytes = fmin(256 << 20, 0.5 * (double)limit);
    const double slice = (double)cw_type_size(part->type) * (double)part->components *
                         (double)part->steps * (double)part->dim[0];
    size_t n = 1;
    while (slice * ceil((double)part->dim[1] / (double)n) *
                   ceil((double)part->dim[2] / (double)n) >
               max_bytes &&
           (n < part->dim[1] || n < part->dim[2]))
        n++;
    choose_coarsening(n, part, step);
    step[0] = 1;
}

static void tell_preview(const cli_volume *volume, const size_t all[3])
{
    const size_t *step = volume->coarsen, *dim = volume->view.dim;
    cli_say("preview: one voxel in %zu x %zu x %zu, %zu x %zu x %zu of %zu x %zu x %zu; "
            "thinner parts may be lost",
            step[0], step[1], step[2], dim[0], dim[1], dim[2], all[0], all[1], all[2]);
}

bool cli_is_preview(const cli_volume *volume)
{
    const size_t *step = volume->coarsen;
    return step[0] > 1 || step[1] > 1 || step[2] > 1;
}

/* The limits are for what will be read: perhaps only a part. */
static cw_status read_shape(const char *path, const cw_read_desc *voxels, cw_volume *shape,
                            const char **format, cw_error *err)
{
    cw_read_desc desc = *voxels;
    desc.header_only = true;
    desc.max_bytes = 0;
    desc.max_voxels = UINT64_MAX;
    return cw_volume_read(path, &desc, shape, format, err);
}

/* Reports the component and the step that were chosen by default. */
static void tell_choice(const cli_input *input, cli_volume *volume)
{
    const cw_volume *v = &volume->whole;
    char text[160];
    if (v->components > 1 && !input->array.component.given) {
        snprintf(text, sizeof text,
                 "component 0 of %zu is taken (--component N, or mag for their magnitude)",
                 v->components);
        cli_take_note(volume, text);
    }
    if (v->steps > 1 && input->step == 0 && !input->step_chosen) {
        snprintf(text, sizeof text, "step 0 of %zu is taken (--step N)", v->steps);
        cli_take_note(volume, text);
    }
}

static cw_status read_header(const char *path, const cw_read_desc *voxels,
                             const cli_input *input, cli_volume *volume, cw_error *err)
{
    cw_status st = read_shape(path, voxels, &volume->whole, &volume->format, err);
    if (st != CW_OK)
        return st;
    cw_volume_spacing(&volume->whole, volume->spacing);
    if (volume->whole.cells)
        find_grid(&volume->whole, volume);
    if (!volume->is_quiet)
        cli_say("%s: %s", path, cli_describe(volume));
    st = check_choice(input, &volume->whole, err);
    if (st == CW_OK)
        tell_choice(input, volume);
    return st == CW_OK ? st : cwi_fail_in(err, st, path);
}

/* Of points and corners, at most. */
static double grid_bytes(const cw_volume *v)
{
    return 3 * sizeof(double) * (double)v->dim[0] + 33 * (double)v->cells->count;
}

/* Reads what has the shape `part`, and counts what memory is left. */
static cw_status read_part(const char *path, cw_read_desc *desc, const cw_volume *part,
                           cli_volume *volume, cw_error *err)
{
    double bytes =
        (double)cw_type_size(part->type) * (double)part->components * (double)part->steps;
    for (int a = 0; a < 3; a++) /* x is thinned in memory only */
        bytes *= ceil((double)part->dim[a] / (double)(a ? volume->coarsen[a] : 1));
    bytes += part->cells ? grid_bytes(part) : 0;
    desc->note = part->cells ? desc->note : NULL; /* said already */
    desc->progress = cli_progress(bytes / 1e6, "MB");
    volume->memory_left = (double)desc->max_bytes > bytes ? desc->max_bytes - (size_t)bytes : 1;
    return cw_volume_read(path, desc, &volume->voxels, &volume->format, err);
}

/* The magnitude takes memory of its own, once. */
static cw_status make_magnitude(const cli_input *input, size_t step, cli_volume *volume,
                                cw_error *err)
{
    const size_t *n = volume->voxels.dim, bytes = n[0] * n[1] * n[2] * sizeof(float);
    const bool first = !volume->magnitude.data;
    if (first && volume->memory_left <= bytes)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "--component mag takes %zu bytes beside the voxels; %zu are left of "
                        "--memory",
                        bytes, volume->memory_left);
    volume->memory_left -= first ? bytes : 0;
    cw_volume_free(&volume->magnitude);
    return cw_volume_magnitude(&volume->voxels, step, (int)input->threads, &volume->magnitude,
                               err);
}

static cw_status select_view(const cli_input *input, size_t step, cli_volume *volume,
                             cw_error *err)
{
    const cli_component *c = &input->array.component;
    if (!c->magnitude)
        return cw_volume_select(&volume->voxels, c->number, step, &volume->view, err);
    cw_status st = make_magnitude(input, step, volume, err);
    return st == CW_OK ? cw_volume_select(&volume->magnitude, 0, 0, &volume->view, err) : st;
}

cw_status cli_choose_step(const cli_input *input, size_t step, cli_volume *volume,
                          cw_error *err)
{
    cw_status st = select_view(input, step, volume, err);
    if (st == CW_OK)
        st = cli_prepare_volume(input, volume, err);
    const cw_volume all = volume->view;
    if (st == CW_OK && input->coarsen_view)
        st = cw_volume_coarsen(&all, volume->coarsen, &volume->view, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
}

double cli_bytes_beside(double voxels, size_t limit)
{
    enum { PROGRAM = 24 << 20 };
    return 0.2 * voxels + (limit < CLI_MIN_MEMORY ? 0 : PROGRAM);
}

/* Returns true if voxels of a shape are to be read slice by slice. */
static bool needs_slices(const cli_input *input, const cw_volume *part, size_t limit)
{
    double voxels = (double)part->components * (double)part->steps;
    for (int a = 0; a < 3; a++)
        voxels *= (double)part->dim[a];
    size_t voxel = cw_type_size(part->type);
    if (input->of_labels && part->type == CW_U32) /* perhaps of 64 bits in the file */
        voxel *= 2;
    if (input->denoise.given)
        voxel += cw_type_size(cli_denoised_type(input, part));
    double bytes = voxels * (double)voxel;
    if (input->of_labels) /* half of the memory is for their surfaces */
        bytes *= 2;
    return input->may_stream && !cli_find_unstreamed_preparation(input) && !part->cells &&
           !part->sparse && input->stream != CLI_STREAM_NEVER &&
           (input->stream == CLI_STREAM_ALWAYS ||
            bytes + cli_bytes_beside(voxels, limit) > (double)limit);
}

/* Makes the view of a volume that streams: a shape without voxels. */
static cw_status view_shape(const cw_volume *part, cli_volume *volume, cw_error *err)
{
    cw_volume *view = &volume->view;
    volume->streams = true;
    *view = *part;
    view->components = view->steps = 1;
    return cwi_volume_thin(view, volume->coarsen, err);
}

/* Finds the numbers of labels that come slice by slice. */
static cw_status find_ids(const char *path, const cw_read_desc *voxels, const cli_input *input,
                          cli_volume *volume, cw_error *err)
{
    cw_read_desc desc = *voxels;
    memcpy(desc.every, volume->coarsen, sizeof desc.every);
    desc.note = NULL;
    desc.max_bytes = 0;
    return cw_label_ids_read(path, &desc, input->step, &volume->ids, err);
}

static cw_status read_voxels(const char *path, cw_read_desc *desc, const cli_input *input,
                             cli_volume *volume, cw_error *err)
{
    cw_volume part = volume->whole;
    cw_box box;
    cw_status st = input->crop.given ? cwi_volume_expect_dense(&part, "a crop", err) : CW_OK;
    if (st == CW_OK && input->crop.given)
        st = find_box(input, &part, volume->is_quiet, &box, err);
    if (st == CW_OK && input->crop.given)
        st = cwi_volume_shrink(&part, &box, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, path);
    desc->region = input->crop.given ? &box : NULL;
    choose_coarsening(pick_coarsening(input), &part, volume->coarsen);
    if (input->sample && !cli_find_preparation(input) && !part.cells && !part.sparse &&
        !cwi_is_rectilinear(&part))
        choose_sample(&part, cli_memory_limit(input), volume->coarsen);
    if (needs_slices(input, &part, desc->max_bytes)) {
        st = view_shape(&part, volume, err);
        if (st == CW_OK && input->of_labels)
            st = find_ids(path, desc, input, volume, err);
        if (st == CW_OK)
            cli_print_slice_filter(input, volume);
        volume->view.type = cli_denoised_type(input, &volume->view);
        return st;
    }
    if (!input->coarsen_view)
        memcpy(desc->every, volume->coarsen, sizeof desc->every);
    st = read_part(path, desc, &part, volume, err);
    if (st == CW_OK && volume->voxels.cells)
        find_grid(&volume->voxels, volume);
    if (st == CW_OK)
        st = cli_choose_step(input, input->step, volume, err);
    if (st == CW_OK && pick_coarsening(input) > 1 && !input->sample)
        tell_preview(volume, part.dim);
    return st;
}

cw_claim cli_claim_of(const cli_claim *c)
{
    return (cw_claim){.has_unit = c->unit > 0,
                      .has_frame = c->frame > 0,
                      .has_up = c->up > 0,
                      .axes = {.unit = (cw_unit)(c->unit > 0 ? c->unit - 1 : 0),
                               .ras = c->frame == 2,
                               .y_up = c->up == 2},
                      .rule = c->override ? CW_CLAIM_OVERRIDE : CW_CLAIM_AGREE};
}

cli_input cli_source_input(const cli_input *input)
{
    cli_input source = *input;
    source.claim = input->source_claim;
    return source;
}

cw_read_desc cli_read_desc(const char *path, const cli_input *input)
{
    cw_read_desc desc = {.stored = cli_stored_input(path),
                         .reader = input->reader,
                         .allow_external = input->allow_external,
                         .series = input->series,
                         .array = input->array.name[0] ? input->array.name : NULL,
                         .level = input->level,
                         .points = input->points,
                         .gaps = (cw_gaps)input->gaps,
                         .tilt = (cw_tilt)input->tilt,
                         .skip_damaged = input->skip_damaged,
                         .no_sandbox = input->no_sandbox,
                         .timeout_s = (double)input->timeout_s,
                         .claim = cli_claim_of(&input->claim),
                         .max_voxels = input->max_voxels,
                         .max_bytes = cli_memory_limit(input)};
    if (input->nodata.given) {
        desc.nodata = input->nodata.is_word ? CW_NODATA_NONE : CW_NODATA_VALUE;
        desc.nodata_value = input->nodata.value;
    }
    if (input->spacing.given)
        memcpy(desc.spacing_mm, input->spacing.mm, sizeof desc.spacing_mm);
    return desc;
}

/* The layout that --raw states, if it does, for the description. */
static cw_status set_raw(const cli_input *input, cw_raw_layout *raw, cw_read_desc *desc,
                         cw_error *err)
{
    if (!input->raw)
        return CW_OK;
    cw_status st = cw_raw_layout_parse(input->raw, raw, err);
    desc->raw = raw;
    return st == CW_OK ? st : cwi_fail_in(err, st, "--raw");
}

cw_status cli_read_shape(const char *path, const cli_input *input, cw_volume *shape,
                         cw_error *err)
{
    cw_raw_layout raw;
    cw_read_desc desc = cli_read_desc(path, input);
    cw_status st = set_raw(input, &raw, &desc, err);
    return st == CW_OK ? read_shape(path, &desc, shape, NULL, err) : st;
}

cw_status cli_read_volume(const char *path, const cli_input *input, bool header_only,
                          cli_volume *volume, cw_error *err)
{
    cw_raw_layout raw;
    cw_read_desc desc = cli_read_desc(path, input);
    memset(volume, 0, sizeof *volume);
    volume->path = path;
    volume->is_quiet = input->is_quiet;
    desc.note = cli_take_note;
    desc.note_user = volume;
    desc.labels = &volume->labels;
    desc.ids = input->of_labels ? &volume->ids : NULL;
    desc.round_labels = input->round_labels;
    cw_status st = cli_check_preparation(input, err);
    if (st == CW_OK)
        st = set_raw(input, &raw, &desc, err);
    if (st == CW_OK)
        st = read_header(path, &desc, input, volume, err);
    desc.labels = NULL; /* the header told them */
    if (st == CW_OK && !header_only)
        st = read_voxels(path, &desc, input, volume, err);
    if (st != CW_OK)
        cli_free_volume(volume);
    return st;
}

cw_status cli_read_any_volume(const char *path, const cli_input *input, cli_volume *volume,
                              cw_error *err)
{
    cli_input labels = *input;
    cw_error other;
    cw_status st = cli_read_volume(path, input, false, volume, err);
    if (st != CW_ERR_FORMAT)
        return st;
    labels.of_labels = labels.is_quiet = true;
    labels.array.component.given = true;
    return cli_read_volume(path, &labels, false, volume, &other) == CW_OK ? CW_OK : st;
}

typedef struct slice_visit {
    const cli_volume *volume;
    const cli_input *input;
} slice_visit;

static cw_status visit_volume(const void *user, const cw_slice_visitor *visitor, cw_error *err)
{
    const cli_volume *volume = ((const slice_visit *)user)->volume;
    const cli_input *input = ((const slice_visit *)user)->input;
    cw_raw_layout raw;
    cw_read_desc desc = cli_read_desc(volume->path, input);
    cw_box box;
    cw_status st = set_raw(input, &raw, &desc, err);
    if (st == CW_OK && input->crop.given) {
        desc.region = &box;
        st = find_box(input, &volume->whole, true, &box, err);
    }
    cw_label_ids ids = volume->ids; /* borrowed */
    desc.ids = input->of_labels ? &ids : NULL;
    desc.round_labels = input->round_labels;
    memcpy(desc.every, volume->coarsen, sizeof desc.every);
    return st == CW_OK ? cw_volume_visit(volume->path, &desc, input->array.component.number,
                                         input->step, visitor, NULL, err)
                       : cwi_fail_in(err, st, volume->path);
}

cw_status cli_visit_slices(const cli_volume *volume, const cli_input *input,
                           const cw_slice_visitor *visitor, cw_error *err)
{
    return cli_visit_filtered(input, visitor, visit_volume, &(slice_visit){volume, input}, err);
}

cw_status cli_read_whole(const cli_volume *part, const cli_input *input, cli_volume *whole,
                         cw_error *err)
{
    cw_raw_layout raw;
    cw_read_desc desc = cli_read_desc(part->path, input);
    *whole = (cli_volume){.path = part->path, .format = part->format};
    whole->memory_left = desc.max_bytes;
    cw_status st = set_raw(input, &raw, &desc, err);
    if (st == CW_OK)
        st = cw_volume_read(part->path, &desc, &whole->voxels, NULL, err);
    if (st == CW_OK)
        st = select_view(input, input->step, whole, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, part->path);
}

/* How many of the labels are inside the surface at a level. 0 is the background. */
static size_t count_inside(const cw_labels *labels, double iso, bool inside_is_low)
{
    size_t inside = 0;
    for (size_t n = 0; n < labels->count; n++)
        inside += labels->value[n] != 0 &&
                  (inside_is_low ? labels->value[n] < iso : labels->value[n] >= iso);
    return inside;
}

cw_status cli_tell_labels(cli_volume *volume, const double *iso, size_t count,
                          bool inside_is_low, cw_error *err)
{
    cw_labels l;
    char text[256], what[CLI_LABELS_TEXT];
    if (volume->magnitude.data || volume->streams)
        return CW_OK;
    cw_status st = cw_volume_labels(&volume->voxels, &l, err); /* of a preview all of them */
    if (st == CW_ERR_NO_MEMORY) /* a note is not worth an error */
        return CW_OK;
    if (st != CW_OK || !l.found || !l.count)
        return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
    cli_describe_labels(volume, &l, what);
    for (size_t n = 0; n < count; n++) {
        const size_t inside = count_inside(&l, iso[n], inside_is_low);
        if (inside < 2)
            continue;
        snprintf(
            text, sizeof text,
            "%s: the surface at %.10g joins %s%zu labels %s it; 'extract --labels' takes each",
            what, iso[n], l.more ? "more than " : "the ", inside,
            inside_is_low ? "below" : "above");
        cli_take_note(volume, text);
    }
    if (!count && l.count > 2) {
        snprintf(text, sizeof text,
                 "%s: an isovalue joins all labels above it; 'extract --labels' takes each",
                 what);
        cli_take_note(volume, text);
    }
    return CW_OK;
}

bool cli_inside_is_low(int inside, const cw_volume *volume)
{
    return inside == CLI_INSIDE_BELOW ||
           (inside == CLI_INSIDE_AUTO && volume->known & CW_KNOWN_LEVEL_SET);
}

bool cli_is_level_set(const char *path, const cli_input *input)
{
    cw_volume shape = {0};
    const bool read = cli_read_shape(path, input, &shape, NULL) == CW_OK;
    const bool is = read && shape.known & CW_KNOWN_LEVEL_SET;
    cw_volume_free(&shape);
    return is;
}
