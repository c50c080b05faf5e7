/* Cleans a label map: components that are too small go to their largest neighbour, and voids of a label to
 * it. Voxels are joined as in extraction, so components are those of the surfaces.
 * Source  connected components by union of runs, with paths halved [TarjanVanLeeuwen1984] */
#include <cubewright/labels.h>

#include "extract/labels/label_layers.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX

/* Voxels of one label that follow each other in a row. */
typedef struct run {
    uint32_t start, end; /* end: the first voxel behind */
    uint32_t label;
    uint32_t set; /* another run of the component; later the component's number */
} run;

/* A set of runs that are joined. */
typedef struct component {
    uint32_t label; /* that it has; changes when it goes to a neighbour */
    uint32_t original;
    size_t voxels;
    bool is_removed; /* it is to go to a neighbour, and has not gone yet */
    bool is_outside; /* it touches the volume's border */
    uint32_t around; /* the only label around it; NONE: none yet, or several */
    bool has_several;
} component;

/* Faces between a component that goes and one beside it. */
typedef struct contact {
    uint32_t from, to;
    size_t faces;
} contact;

typedef struct cleaner {
    cw_volume v;
    const cw_label_clean_desc *desc;
    run *runs;
    size_t run_count, run_room;
    size_t *rows; /* first run of each row, and the end */
    component *components;
    uint32_t component_count;
    contact *contacts;
    size_t contact_count, contact_room;
    cw_label_change *changes;
    size_t change_count;
} cleaner;

static bool add_run(cleaner *c, run r)
{
    if (c->run_count == c->run_room) {
        const size_t room = c->run_room ? 2 * c->run_room : 1024;
        run *grown = cwi_realloc_array(c->runs, room, sizeof *grown);
        if (!grown)
            return false;
        c->runs = grown;
        c->run_room = room;
    }
    c->runs[c->run_count++] = r;
    return true;
}

/* --- runs -------------------------------------------------------------------------------- */

/* Lists the runs of all rows. */
static cw_status list_runs(cleaner *c, cw_error *err)
{
    const cw_volume *v = &c->v;
    const cwi_label_layers layers = {.volume = v,
                                     .background = c->desc->background,
                                     .width = v->dim[0] + 2,
                                     .height = v->dim[1] + 2,
                                     .count = v->dim[2] + 2};
    uint32_t *slice = cwi_alloc_array(layers.width, layers.height * sizeof *slice);
    cw_status st = slice ? CW_OK : cwi_fail_memory(err);
    for (size_t k = 0; k < v->dim[2] && st == CW_OK; k++) {
        size_t bad[3];
        if (!cwi_label_layer_load(&layers, k + 1, slice, bad)) {
            st = cwi_label_fail_voxel(&layers, bad, err);
            break;
        }
        for (size_t j = 0; j < v->dim[1] && st == CW_OK; j++) {
            const uint32_t *row = slice + (j + 1) * layers.width + 1;
            c->rows[k * v->dim[1] + j] = c->run_count;
            for (size_t x = 0, end; x < v->dim[0] && st == CW_OK; x = end) {
                for (end = x + 1; end < v->dim[0] && row[end] == row[x];)
                    end++;
                const run r = {(uint32_t)x, (uint32_t)end, row[x], (uint32_t)c->run_count};
                if (c->run_count >= NONE - 1)
                    st = cwi_fail(err, CW_ERR_LIMIT, "it has 2^32 - 2 runs of voxels");
                else if (!add_run(c, r))
                    st = cwi_fail_memory(err);
            }
        }
    }
    c->rows[v->dim[1] * v->dim[2]] = c->run_count;
    cwi_free(slice);
    return st;
}

static uint32_t find_root(cleaner *c, uint32_t n)
{
    while (c->runs[n].set != n) {
        c->runs[n].set = c->runs[c->runs[n].set].set;
        n = c->runs[n].set;
    }
    return n;
}

/* Joins two runs: the first of all stands for the set. */
static void join_runs(cleaner *c, size_t a, size_t b)
{
    const uint32_t x = find_root(c, (uint32_t)a), y = find_root(c, (uint32_t)b);
    c->runs[x < y ? y : x].set = x < y ? x : y;
}

/* Joins the runs of a row with those of a row below, whose voxels are at the same place or one before. */
static void join_rows(cleaner *c, size_t row, size_t below)
{
    size_t n = c->rows[below];
    for (size_t r = c->rows[row]; r < c->rows[row + 1]; r++) {
        const run *a = &c->runs[r];
        while (n > c->rows[below] && c->runs[n - 1].end >= a->start)
            n--;
        for (; n < c->rows[below + 1] && c->runs[n].start < a->end; n++)
            if (c->runs[n].label == a->label && c->runs[n].end + 1 > a->start)
                join_runs(c, r, n);
    }
}

static void join_all(cleaner *c)
{
    const size_t ny = c->v.dim[1];
    for (size_t row = 0; row < ny * c->v.dim[2]; row++) {
        const bool has_y = row % ny > 0, has_z = row >= ny;
        if (has_y)
            join_rows(c, row, row - 1);
        if (has_z)
            join_rows(c, row, row - ny);
        if (has_y && has_z)
            join_rows(c, row, row - ny - 1);
    }
}

/* --- components -------------------------------------------------------------------------- */

/* Numbers the components by their first run, and counts their voxels. */
static cw_status list_components(cleaner *c, cw_error *err)
{
    uint32_t count = 0;
    for (size_t n = 0; n < c->run_count; n++)
        count += c->runs[n].set == n;
    c->components = cwi_alloc_zeroed(count, sizeof *c->components);
    if (!c->components)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < c->run_count;
         n++) { /* sets point down: those are numbered already */
        run *r = &c->runs[n];
        if (r->set == n) {
            c->components[c->component_count] =
                (component){.label = r->label, .original = r->label, .around = NONE};
            r->set = c->component_count++;
        } else {
            r->set = c->runs[r->set].set;
        }
        c->components[r->set].voxels += r->end - r->start;
    }
    return CW_OK;
}

typedef void visit_faces(cleaner *c, uint32_t a, uint32_t b, size_t faces);

/* Visits the faces between the runs of two rows. */
static void visit_rows(cleaner *c, size_t row, size_t below, visit_faces *visit)
{
    size_t n = c->rows[below];
    for (size_t r = c->rows[row]; r < c->rows[row + 1]; r++) {
        const run *a = &c->runs[r];
        while (n > c->rows[below] && c->runs[n - 1].end > a->start)
            n--;
        for (; n < c->rows[below + 1] && c->runs[n].start < a->end; n++) {
            const run *b = &c->runs[n];
            const uint32_t low = a->start > b->start ? a->start : b->start,
                           high = a->end < b->end ? a->end : b->end;
            if (low < high && a->set != b->set)
                visit(c, a->set, b->set, high - low);
        }
    }
}

/* Visits the faces between different components. */
static void visit_all(cleaner *c, visit_faces *visit)
{
    const size_t ny = c->v.dim[1];
    for (size_t row = 0; row < ny * c->v.dim[2]; row++) {
        for (size_t r = c->rows[row] + 1; r < c->rows[row + 1]; r++)
            if (c->runs[r].set != c->runs[r - 1].set)
                visit(c, c->runs[r].set, c->runs[r - 1].set, 1);
        if (row % ny > 0)
            visit_rows(c, row, row - 1, visit);
        if (row >= ny)
            visit_rows(c, row, row - ny, visit);
    }
}

/* --- what goes --------------------------------------------------------------------------- */

static int compare_sizes(const void *a, const void *b)
{
    const component *x = *(const component *const *)a, *y = *(const component *const *)b;
    if (x->label != y->label)
        return x->label < y->label ? -1 : 1;
    if (x->voxels != y->voxels)
        return x->voxels > y->voxels ? -1 : 1;
    return x < y ? -1 : x > y;
}

/* Marks the components of labels that are too small, or not among the largest. A label keeps its largest
 * one, unless that is too small. */
static cw_status mark_small(cleaner *c, cw_error *err)
{
    const cw_label_clean_desc *d = c->desc;
    const component **order = cwi_alloc_array(c->component_count, sizeof *order);
    size_t rank = 0;
    if (!order)
        return cwi_fail_memory(err);
    for (uint32_t n = 0; n < c->component_count; n++)
        order[n] = &c->components[n];
    qsort(order, c->component_count, sizeof *order, compare_sizes);
    for (uint32_t n = 0; n < c->component_count; n++) {
        component *o = &c->components[order[n] - c->components];
        rank = n > 0 && order[n - 1]->label == o->label ? rank + 1 : 0;
        o->is_removed = o->label != d->background &&
                        (o->voxels < d->min_voxels || (d->largest && rank >= d->largest));
    }
    cwi_free(order);
    return CW_OK;
}

/* Notes the label on the other side of a component of the background. */
static void note_around(cleaner *c, uint32_t a, uint32_t b, size_t faces)
{
    const uint32_t pair[2] = {a, b};
    (void)faces;
    for (int s = 0; s < 2; s++) {
        component *o = &c->components[pair[s]];
        const uint32_t other = c->components[pair[1 - s]].label;
        o->has_several = o->has_several || (o->around != NONE && o->around != other);
        o->around = other;
    }
}

/* Marks components at the volume's border. */
static void mark_outside(cleaner *c)
{
    const size_t nx = c->v.dim[0], ny = c->v.dim[1], nz = c->v.dim[2];
    for (size_t row = 0; row < ny * nz; row++) {
        const size_t j = row % ny, k = row / ny;
        const bool at_border = j == 0 || j + 1 == ny || k == 0 || k + 1 == nz;
        for (size_t r = c->rows[row]; r < c->rows[row + 1]; r++)
            if (at_border || c->runs[r].start == 0 || c->runs[r].end == nx)
                c->components[c->runs[r].set].is_outside = true;
    }
}

/* Gives components of the background that lie in one label to it. */
static void fill_voids(cleaner *c)
{
    mark_outside(c);
    visit_all(c, note_around);
    for (uint32_t n = 0; n < c->component_count; n++) {
        component *o = &c->components[n];
        if (o->original == c->desc->background && !o->is_outside && !o->has_several &&
            o->around != NONE)
            o->label = o->around;
    }
}

/* Lists faces of components that go. */
static void list_contact(cleaner *c, uint32_t a, uint32_t b, size_t faces)
{
    const uint32_t pair[2] = {a, b};
    for (int s = 0; s < 2; s++) {
        if (!c->components[pair[s]].is_removed || c->contact_room == NONE)
            continue;
        if (c->contact_count == c->contact_room) {
            const size_t room = c->contact_room ? 2 * c->contact_room : 1024;
            contact *grown = cwi_realloc_array(c->contacts, room, sizeof *grown);
            if (!grown) {
                c->contact_room = NONE; /* memory is out; clean_map() returns it */
                return;
            }
            c->contacts = grown;
            c->contact_room = room;
        }
        c->contacts[c->contact_count++] = (contact){pair[s], pair[1 - s], faces};
    }
}

static int compare_contacts(const void *a, const void *b)
{
    const contact *x = a, *y = b;
    if (x->from != y->from)
        return x->from < y->from ? -1 : 1;
    return x->to < y->to ? -1 : x->to > y->to;
}

/* Adds up the contacts of the same two components. */
static void sum_contacts(cleaner *c)
{
    size_t count = 0;
    if (c->contact_count)
        qsort(c->contacts, c->contact_count, sizeof *c->contacts, compare_contacts);
    for (size_t n = 0; n < c->contact_count; n++) {
        const contact *o = &c->contacts[n];
        if (count && compare_contacts(&c->contacts[count - 1], o) == 0)
            c->contacts[count - 1].faces += o->faces;
        else
            c->contacts[count++] = *o;
    }
    c->contact_count = count;
}

/* Chooses the label that has the most faces with a component, among those of components that stay. Of
 * equal ones the lowest. Returns NONE where all of its neighbours go, too. */
static uint32_t choose_neighbour(const cleaner *c, size_t first, size_t end)
{
    uint32_t best = NONE;
    size_t most = 0;
    for (size_t n = first; n < end; n++) {
        const component *to = &c->components[c->contacts[n].to];
        size_t faces = 0;
        if (to->is_removed)
            continue;
        for (size_t k = first; k < end; k++) {
            const component *other = &c->components[c->contacts[k].to];
            faces += !other->is_removed && other->label == to->label ? c->contacts[k].faces : 0;
        }
        if (faces > most || (faces == most && to->label < best)) {
            most = faces;
            best = to->label;
        }
    }
    return best;
}

/* Gives components that go to their neighbours, in rounds: some lie among others that go. */
static cw_status remove_marked(cleaner *c, cw_error *err)
{
    uint32_t *chosen = cwi_alloc_array(c->component_count, sizeof *chosen);
    bool moved = true;
    if (!chosen)
        return cwi_fail_memory(err);
    while (moved) {
        moved = false;
        memset(chosen, 0xff, c->component_count * sizeof *chosen);
        for (size_t n = 0, end; n < c->contact_count; n = end) {
            const uint32_t from = c->contacts[n].from;
            for (end = n + 1; end < c->contact_count && c->contacts[end].from == from;)
                end++;
            if (c->components[from].is_removed)
                chosen[from] = choose_neighbour(c, n, end);
        }
        for (uint32_t n = 0; n < c->component_count; n++)
            if (chosen[n] != NONE) {
                c->components[n].label = chosen[n];
                c->components[n].is_removed = false;
                moved = true;
            }
    }
    for (uint32_t n = 0; n < c->component_count; n++)
        if (c->components[n].is_removed) /* nothing that stays is beside it */
            c->components[n].label = c->desc->background;
    cwi_free(chosen);
    return CW_OK;
}

/* --- what changed ------------------------------------------------------------------------ */

static int compare_changes(const void *a, const void *b)
{
    const uint32_t x = ((const cw_label_change *)a)->label,
                   y = ((const cw_label_change *)b)->label;
    return x < y ? -1 : x > y;
}

static cw_label_change *find_change(cleaner *c, uint32_t label)
{
    const cw_label_change key = {.label = label};
    return bsearch(&key, c->changes, c->change_count, sizeof key, compare_changes);
}

/* Tells of each label what it lost and got. */
static cw_status list_changes(cleaner *c, cw_error *err)
{
    size_t count = 0;
    c->changes = cwi_alloc_zeroed((size_t)c->component_count + 1, sizeof *c->changes);
    if (!c->changes)
        return cwi_fail_memory(err);
    for (uint32_t n = 0; n < c->component_count; n++)
        c->changes[n].label = c->components[n].original;
    qsort(c->changes, c->component_count, sizeof *c->changes, compare_changes);
    for (uint32_t n = 0; n < c->component_count; n++)
        if ((count == 0 || c->changes[count - 1].label != c->changes[n].label) &&
            c->changes[n].label != c->desc->background)
            c->changes[count++] = c->changes[n];
    c->change_count = count;
    for (uint32_t n = 0; n < c->component_count; n++) {
        const component *o = &c->components[n];
        cw_label_change *before = find_change(c, o->original), *now = find_change(c, o->label);
        if (before)
            before->voxels_before += o->voxels;
        if (now)
            now->voxels += o->voxels;
        if (o->label == o->original)
            continue;
        if (before) {
            before->components_removed++;
            before->voxels_removed += o->voxels;
        }
        if (now)
            now->voxels_added += o->voxels;
    }
    return CW_OK;
}

static cw_status write_voxels(const cleaner *c, cw_volume *cleaned, cw_error *err)
{
    const cw_volume *v = &c->v;
    cw_status st = cw_volume_alloc(cleaned, CW_U32, v->dim, 1, 1, err);
    if (st != CW_OK)
        return st;
    memcpy(cleaned->affine, v->affine, sizeof cleaned->affine);
    memcpy(cleaned->coordinates, v->coordinates, sizeof cleaned->coordinates);
    cleaned->known = v->known;
    cleaned->said_unit_mm = v->said_unit_mm;
    cleaned->said_ras = v->said_ras;
    uint32_t *to = cw_volume_voxels(cleaned);
    for (size_t n = 0; n < c->run_count; n++)
        for (uint32_t x = c->runs[n].start; x < c->runs[n].end; x++)
            *to++ = c->components[c->runs[n].set].label;
    st = cwi_volume_own_coordinates(cleaned, err);
    if (st != CW_OK)
        cw_volume_free(cleaned);
    return st;
}

static void free_cleaner(cleaner *c)
{
    cwi_free(c->runs);
    cwi_free(c->rows);
    cwi_free(c->components);
    cwi_free(c->contacts);
}

static cw_status clean_map(cleaner *c, cw_volume *cleaned, cw_error *err)
{
    c->rows = cwi_alloc_array(c->v.dim[1] * c->v.dim[2] + 1, sizeof *c->rows);
    cw_status st = c->rows ? list_runs(c, err) : cwi_fail_memory(err);
    if (st != CW_OK)
        return st;
    join_all(c);
    st = list_components(c, err);
    if (st == CW_OK && c->desc->fill_voids)
        fill_voids(c);
    if (st == CW_OK)
        st = mark_small(c, err);
    if (st == CW_OK) {
        visit_all(c, list_contact);
        st = c->contact_room == NONE ? cwi_fail_memory(err) : CW_OK;
    }
    if (st == CW_OK) {
        sum_contacts(c);
        st = remove_marked(c, err);
    }
    if (st == CW_OK)
        st = list_changes(c, err);
    return st == CW_OK ? write_voxels(c, cleaned, err) : st;
}

cw_status cw_labels_clean(const cw_volume *volume, const cw_label_clean_desc *desc,
                          cw_volume *cleaned, cw_label_change **changes, size_t *count,
                          cw_error *err)
{
    CWI_REQUIRE(err, volume, desc, cleaned);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cleaner c = {.desc = desc};
    memset(cleaned, 0, sizeof *cleaned);
    cw_status st = cw_volume_resolve(volume, &c.v, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&c.v, "cleaning labels", err);
    if (st == CW_OK && (c.v.dim[0] >= NONE || c.v.dim[1] >= NONE || c.v.dim[2] >= NONE))
        st = cwi_fail(err, CW_ERR_LIMIT, "it has 2^32 - 1 voxels along an axis");
    if (st == CW_OK)
        st = clean_map(&c, cleaned, err);
    free_cleaner(&c);
    if (st == CW_OK && changes && count) {
        *changes = c.changes;
        *count = c.change_count;
    } else {
        cwi_free(c.changes);
        if (changes)
            *changes = NULL;
        if (count)
            *count = 0;
    }
    return st;
}

void cw_label_changes_free(cw_label_change *changes)
{
    cwi_free(changes);
}
