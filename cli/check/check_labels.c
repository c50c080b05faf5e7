/* Checks files of several solids that share their interfaces: each solid by itself, how they meet, and how
 * each differs from its label in a source. */
#include "cli/check/check_labels.h"

#include "cli/framework/console.h"
#include "cli/results/write_result.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/box.h"
#include "core/texture/gather_meshes.h"

#include <cubewright/labels.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Labels keep the volume of their voxels within this share. */
static const double VOLUME_SHARE = 0.005;

/* --- solids ------------------------------------------------------------------------------ */

void cli_free_part_checks(cli_part_checks *solids)
{
    for (size_t n = 0; n < solids->count && !solids->parts.parts; n++)
        cw_mesh_free(&solids->items[n].mesh);
    free(solids->items);
    cw_crossings_free(&solids->crossings);
    cli_free_mesh(&solids->parts);
    *solids = (cli_part_checks){0};
}

static int compare_labels(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

/* Lists the labels of vertices, rising. *count is 0 where a triangle has several. */
static cw_status list_labels(const cw_mesh *mesh, uint32_t **labels, size_t *count,
                             cw_error *err)
{
    *count = 0;
    *labels = malloc((mesh->triangle_count + 1) * sizeof **labels);
    if (!*labels)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangles + 3 * t;
        (*labels)[t] = mesh->labels[v[0]];
        if (mesh->labels[v[1]] != (*labels)[t] || mesh->labels[v[2]] != (*labels)[t])
            return CW_OK;
    }
    qsort(*labels, mesh->triangle_count, sizeof **labels, compare_labels);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (t == 0 || (*labels)[t] != (*labels)[t - 1])
            (*labels)[(*count)++] = (*labels)[t];
    return CW_OK;
}

/* Allocates the mesh of a label whose vertices and triangles were counted. */
static cw_status allocate_label(const cw_mesh *all, cw_mesh *out, cw_error *err)
{
    memcpy(out->origin, all->origin, sizeof out->origin);
    memcpy(out->affine, all->affine, sizeof out->affine);
    out->positions = cwi_alloc_array(out->vertex_count, 3 * sizeof(float));
    out->triangles = cwi_alloc_array(out->triangle_count, 3 * sizeof(uint32_t));
    if (all->normals)
        out->normals = cwi_alloc_array(out->vertex_count, 3 * sizeof(float));
    return out->positions && out->triangles && (out->normals || !all->normals)
               ? CW_OK
               : cwi_fail_memory(err);
}

/* Finds the solid of a label; NULL: no triangle has that label. */
static cli_part_check *find_solid(const cli_part_checks *solids, uint32_t label)
{
    size_t low = 0, high = solids->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (solids->items[middle].label.value < label)
            low = middle + 1;
        else
            high = middle;
    }
    return low < solids->count && solids->items[low].label.value == label ? &solids->items[low]
                                                                          : NULL;
}

/* Copies triangles, with their vertices, to the solids of their labels. number: vertex_count, for the work */
static cw_status copy_labels(const cw_mesh *all, const cli_part_checks *solids,
                             uint32_t *number, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t v = 0; v < all->vertex_count; v++) {
        cli_part_check *solid = find_solid(solids, all->labels[v]);
        number[v] = solid ? (uint32_t)solid->mesh.vertex_count++ : 0;
    }
    for (size_t t = 0; t < all->triangle_count; t++)
        find_solid(solids, all->labels[all->triangles[3 * t]])->mesh.triangle_count++;
    for (size_t n = 0; n < solids->count && st == CW_OK; n++) {
        st = allocate_label(all, &solids->items[n].mesh, err);
        solids->items[n].mesh.triangle_count = 0;
    }
    if (st != CW_OK)
        return st;
    for (size_t v = 0; v < all->vertex_count; v++) {
        cli_part_check *solid = find_solid(solids, all->labels[v]);
        if (!solid)
            continue;
        cw_mesh *out = &solid->mesh;
        memcpy(out->positions + 3 * (size_t)number[v], all->positions + 3 * v,
               3 * sizeof(float));
        if (all->normals)
            memcpy(out->normals + 3 * (size_t)number[v], all->normals + 3 * v,
                   3 * sizeof(float));
    }
    for (size_t t = 0; t < all->triangle_count; t++) {
        const uint32_t *v = all->triangles + 3 * t;
        cw_mesh *out = &find_solid(solids, all->labels[v[0]])->mesh;
        for (size_t c = 0; c < 3; c++)
            out->triangles[3 * out->triangle_count + c] = number[v[c]];
        out->triangle_count++;
    }
    return CW_OK;
}

/* Parts a mesh by the labels of its vertices. */
static cw_status split_labels(const cw_mesh *mesh, cli_part_checks *solids, cw_error *err)
{
    uint32_t *labels = NULL, *number = NULL;
    size_t count;
    cw_status st = list_labels(mesh, &labels, &count, err);
    if (st == CW_OK && count > 1) {
        number = malloc(mesh->vertex_count * sizeof *number);
        solids->items = calloc(count, sizeof *solids->items);
        st = number && solids->items ? CW_OK : cwi_fail_memory(err);
    }
    for (size_t n = 0; n < count && count > 1 && st == CW_OK; n++)
        solids->items[solids->count++] =
            (cli_part_check){.has_label = true, .label = {.value = labels[n]}};
    if (st == CW_OK && solids->count)
        st = copy_labels(mesh, solids, number, err);
    solids->of_labels = solids->count > 0;
    free(number);
    free(labels);
    return st;
}

/* Takes the parts of the file that are no coarser levels of others. */
static cw_status take_parts(cli_check_run *s, cli_part_checks *solids, cw_error *err)
{
    cw_status st = cli_read_parts_again(&s->mesh, false, s->args->mesh_reader, &s->args->input,
                                        &solids->parts, err);
    if (st != CW_OK)
        return st;
    solids->items = calloc(solids->parts.part_count + 1, sizeof *solids->items);
    if (!solids->items)
        return cwi_fail_memory(err);
    solids->of_labels = true;
    for (size_t n = 0; n < solids->parts.part_count; n++) {
        const cw_part *part = &solids->parts.parts[n];
        cli_part_check *solid = &solids->items[solids->count];
        if (part->level > 0)
            continue;
        solids->count++;
        solid->mesh = *part->mesh;
        solid->has_label = part->label != NULL;
        solids->of_labels = solids->of_labels && solid->has_label;
        if (part->label)
            solid->label = *part->label;
        snprintf(solid->name, sizeof solid->name, "%s", part->name ? part->name : "");
    }
    return CW_OK;
}

/* Names a solid for people: "label 5 (Liver)", or the name of its part. */
static void name_solid(cli_part_check *solid, size_t number)
{
    char name[sizeof solid->name], digits[CW_LABEL_NUMBER], plain[CW_LABEL_NUMBER + 8];
    snprintf(name, sizeof name, "%.90s", solid->name);
    snprintf(plain, sizeof plain, "label_%s", cw_label_number(&solid->label, digits));
    if (!solid->has_label && *name)
        return;
    if (!solid->has_label)
        snprintf(solid->name, sizeof solid->name, "part %zu", number + 1);
    else if (*name && strcmp(name, plain) != 0)
        snprintf(solid->name, sizeof solid->name, "label %s (%.80s)", digits, name);
    else
        snprintf(solid->name, sizeof solid->name, "label %s", digits);
}

/* Merges all solids. part_of: the number of the solid of each triangle */
static cw_status merge_solids(const cli_part_checks *solids, cw_mesh *all, uint32_t **part_of,
                              cw_error *err)
{
    const cw_mesh **meshes = malloc(solids->count * sizeof *meshes);
    if (!meshes)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < solids->count; n++)
        meshes[n] = &solids->items[n].mesh;
    cw_status st = cwi_gather_meshes(meshes, NULL, solids->count, false, false, all, err);
    free(meshes);
    *part_of = st == CW_OK ? malloc((all->triangle_count + 1) * sizeof **part_of) : NULL;
    if (st == CW_OK && !*part_of)
        return cwi_fail_memory(err);
    for (size_t n = 0, to = 0; n < solids->count && st == CW_OK; n++)
        for (size_t t = 0; t < solids->items[n].mesh.triangle_count; t++)
            (*part_of)[to++] = (uint32_t)n;
    return st;
}

static bool wants_crossings(const cli_check_args *args)
{
    return args->deep || cw_check_wants_crossings((cw_profile)args->profile);
}

/* Finds how the solids meet. */
static cw_status measure_contacts(cli_check_run *s, cli_part_checks *solids, cw_error *err)
{
    cw_mesh all = {0}, once = {0};
    uint32_t *part_of = NULL;
    cw_status st = merge_solids(solids, &all, &part_of, err);
    if (st == CW_OK)
        st = cw_contacts_find(&all, part_of, &solids->contacts, &once, err);
    if (st == CW_OK && solids->of_labels && wants_crossings(s->args)) {
        const cw_crossings_desc desc = {.weld = CW_WELD_LOCAL,
                                        .threads = (int)s->args->input.threads};
        st = cw_self_intersections(&once, &desc, &solids->crossings, err);
        solids->has_crossings = st == CW_OK;
    }
    cw_mesh_free(&all);
    cw_mesh_free(&once);
    free(part_of);
    return st == CW_OK ? st : cwi_fail_in(err, st, s->mesh.path);
}

cw_status cli_find_part_checks(cli_check_run *s, cli_part_checks *solids, cw_error *err)
{
    const cw_mesh *mesh = &s->mesh.mesh;
    cw_status st = CW_OK;
    if (s->mesh.file.parts > 1)
        st = take_parts(s, solids, err);
    else if (mesh->labels && mesh->triangle_count)
        st = split_labels(mesh, solids, err);
    for (size_t n = 0; n < solids->count; n++)
        name_solid(&solids->items[n], n);
    if (st == CW_OK && solids->count > 1)
        st = measure_contacts(s, solids, err);
    if (st != CW_OK || solids->count < 2 || (!solids->of_labels && !solids->contacts.shared))
        cli_free_part_checks(solids); /* one mesh, or parts that do not touch */
    return st;
}

/* --- verdicts ---------------------------------------------------------------------------- */

/* Verdicts of all solids under one name. */
typedef struct joined {
    cw_verdict worst;
    const cli_part_check *of; /* whose it is */
    size_t as_bad;            /* others with that grade */
    bool differs;             /* texts do */
} joined;

typedef struct verdict_list {
    joined items[CW_MAX_VERDICTS];
    size_t count;
} verdict_list;

/* Returns true if a verdict of a solid is worse than one of another under the same name. Numbers are
 * counts and areas of faults, but for two angles, which are better if they are wide. */
static bool is_worse(const cw_verdict *v, const cw_verdict *than)
{
    const bool is_angle = strcmp(v->name, "shapes") == 0 || strcmp(v->name, "stability") == 0;
    if (v->grade != than->grade)
        return v->grade < than->grade;
    return is_angle ? v->number < than->number : v->number > than->number;
}

static void join_verdict(verdict_list *list, const cw_verdict *v, const cli_part_check *solid)
{
    joined *j = NULL;
    for (size_t n = 0; n < list->count && !j; n++)
        j = strcmp(list->items[n].worst.name, v->name) == 0 ? &list->items[n] : NULL;
    if (!j && list->count < CW_MAX_VERDICTS - 4) {
        list->items[list->count++] = (joined){*v, solid, 0, false};
        return;
    }
    if (!j)
        return;
    j->differs = j->differs || strcmp(j->worst.text, v->text) != 0;
    if (is_worse(v, &j->worst)) {
        j->as_bad = v->grade == j->worst.grade ? j->as_bad + 1 : 0;
        j->worst = *v;
        j->of = solid;
    } else {
        j->as_bad += v->grade == j->worst.grade;
    }
}

static cw_verdict *add_verdict(cli_check_run *s, const char *name, cw_grade grade,
                               double number)
{
    cw_verdict *v = &s->verdicts[s->verdict_count++];
    *v = (cw_verdict){.name = name, .grade = grade, .number = number};
    return v;
}

/* Writes the verdicts of all solids, with the name of the worst where they differ. */
static void take_verdicts(cli_check_run *s, const verdict_list *list)
{
    for (size_t n = 0; n < list->count; n++) {
        const joined *j = &list->items[n];
        cw_verdict *v = &s->verdicts[s->verdict_count++];
        char more[48] = "";
        *v = j->worst;
        if (!j->differs)
            continue;
        if (j->as_bad && j->worst.grade < CW_GRADE_OK)
            snprintf(more, sizeof more, "; and %zu more", j->as_bad);
        const size_t taken = strlen(j->of->name) + strlen(more) + 3;
        const int left = taken < sizeof v->text ? (int)(sizeof v->text - taken) : 0;
        snprintf(v->text, sizeof v->text, "%s: %.*s%s", j->of->name, left, j->worst.text, more);
    }
}

static void judge_contacts(cli_check_run *s, const cli_part_checks *solids)
{
    const cw_contacts *c = &solids->contacts;
    const char *what = solids->of_labels ? "labels" : "parts";
    cw_verdict *v = add_verdict(s, "interfaces", c->overlapping ? CW_GRADE_FAIL : CW_GRADE_OK,
                                (double)(c->overlapping ? c->overlapping : c->shared));
    if (c->overlapping) {
        snprintf(v->text, sizeof v->text,
                 "%zu triangles that two %s see from the same side: they overlap",
                 c->overlapping, what);
        v->advice = "extract them together: --labels";
    } else if (c->shared) {
        snprintf(v->text, sizeof v->text,
                 "%zu pairs of %s share %zu triangles, each seen from both sides",
                 c->neighbours, what, c->shared);
    } else {
        snprintf(v->text, sizeof v->text, "no two %s share a triangle", what);
    }
    if (!solids->has_crossings)
        return;
    const bool crosses = solids->crossings.count > 0;
    v = add_verdict(s, "between labels", crosses ? CW_GRADE_FAIL : CW_GRADE_OK,
                    (double)solids->crossings.count);
    if (crosses)
        snprintf(v->text, sizeof v->text, "%zu pairs of triangles cross",
                 solids->crossings.count);
    else
        snprintf(v->text, sizeof v->text, "no triangles cross");
}

/* Sorts the verdicts from the worst to the best; equal ones keep their order. */
static void sort_verdicts(cli_check_run *s)
{
    for (size_t n = 1; n < s->verdict_count; n++)
        for (size_t k = n; k > 0 && s->verdicts[k - 1].grade > s->verdicts[k].grade; k--) {
            const cw_verdict kept = s->verdicts[k];
            s->verdicts[k] = s->verdicts[k - 1];
            s->verdicts[k - 1] = kept;
        }
}

/* --- the source -------------------------------------------------------------------------- */

/* Makes the voxels of a label around its mesh a volume of 0 and 1. */
static cw_status make_mask(const cw_volume *map, uint32_t value, const cw_mesh *mesh,
                           cw_volume *mask, cw_error *err)
{
    enum { AROUND = 2 }; /* voxels */
    double low[3], high[3], first[3], last[3];
    cw_box box;
    cw_volume part;
    cw_mesh_bounds(mesh, low, high);
    cwi_box_clear(first, last);
    cw_status st = CW_OK;
    for (int corner = 0; corner < 8 && st == CW_OK; corner++) {
        double world[3], index[3];
        for (int a = 0; a < 3; a++)
            world[a] = corner >> a & 1 ? high[a] : low[a];
        st = cw_volume_to_index(map, world, index, err);
        if (st == CW_OK)
            cwi_box_add(first, last, index);
    }
    for (int a = 0; a < 3 && st == CW_OK; a++) {
        const double end = (double)map->dim[a] - 1;
        const double from = fmin(fmax(floor(first[a]) - AROUND, 0), fmax(end - 1, 0));
        const double to = fmin(fmax(ceil(last[a]) + AROUND, from + 1), end);
        box.first[a] = (size_t)from;
        box.count[a] = (size_t)(to - from) + 1;
    }
    if (st == CW_OK)
        st = cw_volume_crop(map, &box, &part, err);
    if (st == CW_OK)
        st = cw_volume_alloc(mask, CW_U8, box.count, 1, 1, err);
    if (st != CW_OK)
        return st;
    memcpy(mask->affine, part.affine, sizeof mask->affine);
    uint8_t *to = cw_volume_voxels(mask);
    for (size_t k = 0; k < box.count[2]; k++)
        for (size_t j = 0; j < box.count[1]; j++)
            for (size_t i = 0; i < box.count[0]; i++)
                *to++ = cw_volume_value(&part, i, j, k) == value;
    return CW_OK;
}

/* Measures the distance of a solid from its label. */
static cw_status measure_from_label(cli_check_run *s, uint32_t value, cli_part_check *solid,
                                    cw_error *err)
{
    cw_volume mask = {0};
    cw_distance d = {0};
    const cw_field_distance_desc desc = {
        .isovalue = 0.5, .leave_open = s->args->open, .threads = (int)s->args->input.threads};
    cw_status st = make_mask(&s->volume.view, value, &solid->mesh, &mask, err);
    if (st == CW_OK)
        st = cw_distance_to_field(&solid->mesh, &mask, &desc, &d, NULL, err);
    cw_volume_free(&mask);
    solid->max_mm = st == CW_OK ? d.max_mm : NAN;
    return st;
}

static void judge_volumes(cli_check_run *s, const cli_part_checks *solids, size_t lacking)
{
    double worst = 0;
    const cli_part_check *of = NULL;
    size_t off = 0, compared = 0;
    for (size_t n = 0; n < solids->count; n++) {
        const cli_part_check *solid = &solids->items[n];
        if (!solid->voxels || solid->quality.open_edges)
            continue;
        const double share = fabs(solid->quality.volume_mm3 / solid->voxel_mm3 - 1);
        compared++;
        off += share > VOLUME_SHARE;
        if (!of || share > worst) {
            worst = share;
            of = solid;
        }
    }
    if (lacking) {
        cw_verdict *v = add_verdict(s, "labels", CW_GRADE_WARN, (double)lacking);
        snprintf(v->text, sizeof v->text, "%zu labels of the source have no surface", lacking);
    }
    if (!of)
        return;
    cw_verdict *v = add_verdict(s, "volumes", off ? CW_GRADE_WARN : CW_GRADE_OK, 100 * worst);
    snprintf(
        v->text, sizeof v->text,
        "%.100s is off the volume of its voxels by %.3g %%, the most; %zu of %zu are within "
        "0.5 %%",
        of->name, 100 * worst, compared - off, compared);
}

static void judge_distances(cli_check_run *s, const cli_part_checks *solids)
{
    const cli_part_check *of = NULL;
    for (size_t n = 0; n < solids->count; n++)
        if (!isnan(solids->items[n].max_mm) && (!of || solids->items[n].max_mm > of->max_mm))
            of = &solids->items[n];
    if (!of)
        return;
    const double tolerance = s->findings.tolerance_mm;
    const bool fails = tolerance > 0 && of->max_mm > tolerance;
    cw_verdict *v = add_verdict(s, "distance",
                                fails           ? CW_GRADE_FAIL
                                : tolerance > 0 ? CW_GRADE_OK
                                                : CW_GRADE_NOTE,
                                of->max_mm);
    snprintf(v->text, sizeof v->text,
             "%.100s is up to %.4g mm from its voxels' surface, the most", of->name,
             of->max_mm);
    if (fails)
        v->advice = "allow more with --tolerance, or smooth and simplify less";
}

static int compare_counts(const void *a, const void *b)
{
    const uint32_t x = ((const cw_label_count *)a)->label,
                   y = ((const cw_label_count *)b)->label;
    return x < y ? -1 : x > y;
}

/* Compares each solid with the label of its number. */
static cw_status compare_with_source(cli_check_run *s, cli_part_checks *solids, cw_error *err)
{
    cw_label_count *counts = NULL;
    size_t count = 0, found = 0, strange = 0;
    const double voxel = fabs(cwi_affine_determinant(s->volume.view.affine[0]));
    cw_status st = cw_label_counts(&s->volume.view, 0, &counts, &count, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->volume.path);
    for (size_t n = 0; n < solids->count && st == CW_OK; n++) {
        cli_part_check *solid = &solids->items[n];
        const uint32_t value = cw_label_ids_find(&s->volume.ids, &solid->label);
        const cw_label_count key = {.label = value},
                             *found_count = count ? bsearch(&key, counts, count, sizeof key,
                                                            compare_counts)
                                                  : NULL;
        solid->voxels = found_count ? found_count->voxels : 0;
        solid->voxel_mm3 = voxel * (double)solid->voxels;
        found += solid->voxels > 0;
        strange += solid->voxels == 0;
        if (solid->voxels)
            st = measure_from_label(s, value, solid, err);
    }
    cw_label_counts_free(counts);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->mesh.path);
    if (strange) {
        cw_verdict *v = add_verdict(s, "source", CW_GRADE_FAIL, (double)strange);
        snprintf(v->text, sizeof v->text, "%zu labels of the mesh have no voxels in the source",
                 strange);
    }
    judge_volumes(s, solids, count - (found < count ? found : count));
    judge_distances(s, solids);
    return CW_OK;
}

/* --- all --------------------------------------------------------------------------------- */

/* Measures one solid as a mesh of its own. */
static cw_status check_solid(const cli_check_run *s, cli_part_check *solid, verdict_list *list,
                             cw_error *err)
{
    cli_check_args args = *s->args;
    args.source = args.reference = args.looks = args.defects = NULL;
    args.tolerance = (cli_length){0};
    cli_check_run *one = calloc(1, sizeof *one);
    if (!one)
        return cwi_fail_memory(err);
    one->args = &args;
    one->mesh = s->mesh;
    one->mesh.mesh = solid->mesh;
    cw_status st = cli_check_measure(one, err);
    if (st == CW_OK) {
        one->verdict_count =
            cw_check_judge(&one->findings, (cw_profile)args.profile, one->verdicts);
        for (size_t n = 0; n < one->verdict_count; n++)
            join_verdict(list, &one->verdicts[n], solid);
        solid->quality = one->quality;
    }
    cw_crossings_free(&one->crossings);
    free(one);
    return st;
}

cw_status cli_check_parts(cli_check_run *s, cli_part_checks *solids, cw_error *err)
{
    verdict_list list = {.count = 0};
    cw_status st = CW_OK;
    for (size_t n = 0; n < solids->count && st == CW_OK; n++) {
        cli_part_check *solid = &solids->items[n];
        solid->max_mm = NAN;
        st = check_solid(s, solid, &list, err);
        if (st == CW_OK && n == 0)
            s->quality = solid->quality;
        else if (st == CW_OK)
            cli_add_quality(&s->quality, &solid->quality);
    }
    if (st != CW_OK)
        return st;
    s->findings.quality = &s->quality;
    s->findings.tolerance_mm = cli_check_tolerance_mm(s);
    take_verdicts(s, &list);
    judge_contacts(s, solids);
    if (s->args->source)
        st = compare_with_source(s, solids, err);
    sort_verdicts(s);
    return st;
}

void cli_json_part_checks(cli_json *j, const cli_part_checks *solids)
{
    if (!solids->count)
        return;
    cli_json_open(j, "interfaces", '{');
    cli_json_count(j, "shared_triangles", solids->contacts.shared);
    cli_json_count(j, "overlapping_triangles", solids->contacts.overlapping);
    cli_json_count(j, "neighbours", solids->contacts.neighbours);
    cli_json_close(j, '}');
    cli_json_open(j, "solids", '[');
    for (size_t n = 0; n < solids->count; n++) {
        const cli_part_check *solid = &solids->items[n];
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "name", solid->name);
        if (solid->has_label)
            cli_json_label(j, "label", &solid->label);
        cli_json_bool(j, "closed_manifold", cw_quality_is_closed_manifold(&solid->quality));
        cli_json_count(j, "triangles", solid->quality.triangles);
        cli_json_count(j, "components", solid->quality.components);
        cli_json_number(j, "area", solid->quality.area_mm2);
        cli_json_number(j, "volume",
                        solid->quality.open_edges ? NAN : solid->quality.volume_mm3);
        if (solid->voxels) {
            cli_json_number(j, "voxel_volume", solid->voxel_mm3);
            cli_json_number(j, "max_distance", solid->max_mm);
        }
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}
