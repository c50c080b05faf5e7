/* Places of pegs: in each region of each section, far from the border and from each other, where the material
 * beside the section is thick enough. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "simplify/pieces/peg_sizes.h"
#include "simplify/pieces/section_map.h"

#include <math.h>
#include <string.h>

/* Fractions of the length that are tried one after the other. */
static const double length_fractions[] = {1, 0.75, 0.5, 0.35};

/* Cells nearer to a blocked one than the radius less this many may still have room: cells on the border count
 * as blocked. */
static const double CELL_SLACK = 1.5;

/* Pegs keep this fraction of the largest distance to the border, where that leaves room for all. */
static const double INNER_FRACTION = 0.6;

static const double DEFAULT_CLEARANCE_MM = 0.2;

/* A diameter that was not given: of the widest that has room, at first and from try to try. Sections that are
 * nearly as wide as the widest count in this. */
static const double FIRST_FRACTION = 0.8, SMALLER = 0.7, WIDE = 0.9;

/* Places in a region that turn out to have no room, before the search ends. */
enum { MAX_FAILURES = 60 };

/* A region that gets its pegs. */
typedef struct peg_search {
    cwi_cutter *c;
    const cwi_section_map *map;
    size_t section;
    const size_t *cells; /* of the region */
    double *spacing_sq;  /* of these: to the nearest peg; negative: not to be used */
    size_t cell_count;
    uint32_t region;
    cwi_peg_sizes sizes; /* of pegs of the length that is tried */
    double length;
    cw_peg *found; /* count of them */
    double (*places)[2];
    size_t count;
} peg_search;

/* --- one peg ------------------------------------------------------------------------------ */

/* Returns the least distance of two line segments. */
static double find_gap(double p[2][3], double q[2][3])
{
    double least = INFINITY;
    double d[3], e[3], r[3];
    cwi_sub(p[1], p[0], d);
    cwi_sub(q[1], q[0], e);
    cwi_sub(p[0], q[0], r);
    const double a = cwi_dot(d, d), b = cwi_dot(d, e), c = cwi_dot(e, e), f = cwi_dot(d, r),
                 g = cwi_dot(e, r), det = a * c - b * b;
    if (det > 1e-12 * a * c) {
        const double s = (b * g - c * f) / det, t = (a * g - b * f) / det;
        if (s >= 0 && s <= 1 && t >= 0 && t <= 1) {
            double x[3], y[3];
            cwi_add_scaled(p[0], s, d, x);
            cwi_add_scaled(q[0], t, e, y);
            least = cwi_distance(x, y);
        }
    }
    for (int k = 0; k < 4; k++) { /* the ends of each beside the other */
        double(*line)[3] = k < 2 ? q : p;
        const double *end = k < 2 ? p[k] : q[k - 2], *along = k < 2 ? e : d;
        double w[3], x[3];
        cwi_sub(end, line[0], w);
        const double t = cwi_dot(w, along) / cwi_dot(along, along);
        cwi_add_scaled(line[0], t < 0 ? 0 : t > 1 ? 1 : t, along, x);
        least = cwi_lesser(least, cwi_distance(x, end));
    }
    return least;
}

/* Finds the ends of the axis of all that a peg takes in both pieces. */
static void find_axis(const cw_pieces_desc *d, const cw_peg *peg, double axis[2][3])
{
    const cwi_peg_sizes s = cwi_find_peg_sizes(d, peg->diameter_mm, peg->length_mm);
    cwi_add_scaled(peg->center, -s.below, peg->direction, axis[0]);
    cwi_add_scaled(peg->center, s.above, peg->direction, axis[1]);
}

/* Returns true if a peg comes too near to one of another section of the same pieces. */
static bool meets_another(const peg_search *s, const cw_peg *peg)
{
    const cw_pieces *o = s->c->out;
    const cw_piece_section *own = &o->sections[s->section];
    double axis[2][3], other[2][3];
    find_axis(&o->settings, peg, axis);
    for (size_t n = 0; n < o->peg_count; n++) {
        const cw_piece_section *theirs = &o->sections[o->pegs[n].section];
        if (theirs->below != own->below && theirs->below != own->above &&
            theirs->above != own->below && theirs->above != own->above)
            continue;
        find_axis(&o->settings, &o->pegs[n], other);
        if (find_gap(axis, other) < 2 * s->sizes.hole_radius + s->sizes.wall)
            return true;
    }
    return false;
}

/* Checks a place exactly, after moving it a little where it is near the border; true: a peg goes there. */
static bool has_room(const peg_search *s, double p[2], cw_peg *peg)
{
    const cwi_cut_plane *plane = s->map->plane;
    const double radius = s->sizes.hole_radius + s->sizes.wall;
    const double border = cwi_peg_room(radius);
    if (cwi_border_distance(s->map, s->region, p) < border &&
        cwi_leave_border(s->map, s->region, p) < border)
        return false;
    for (size_t n = 0; n < s->count; n++)
        if (hypot(p[0] - s->places[n][0], p[1] - s->places[n][1]) <
            2 * s->sizes.hole_radius + s->sizes.wall)
            return false;
    if (cwi_section_depth(s->map, 0, p, radius) < s->sizes.deep[0] ||
        cwi_section_depth(s->map, 1, p, radius) < s->sizes.deep[1])
        return false;
    *peg = (cw_peg){.section = s->section,
                    .diameter_mm = s->c->out->settings.peg_diameter_mm,
                    .length_mm = s->length};
    for (int k = 0; k < 3; k++) {
        peg->center[k] = plane->point[k] + p[0] * plane->u[k] + p[1] * plane->v[k];
        peg->direction[k] = plane->normal[k];
    }
    return !meets_another(s, peg);
}

/* --- one region --------------------------------------------------------------------------- */

/* Finds the cell that is farthest from pegs, or without one the cell in which to begin. Returns cell_count for
 * none.
 * reach_sq  the least distance to blocked cells, in cells */
static size_t find_cell(const peg_search *s, double reach_sq, bool is_single)
{
    const double *distance_sq = s->map->distance_sq;
    size_t deepest = s->cell_count, best = s->cell_count;
    for (size_t n = 0; n < s->cell_count; n++)
        if (s->spacing_sq[n] >= 0 && distance_sq[s->cells[n]] >= reach_sq &&
            (deepest == s->cell_count ||
             distance_sq[s->cells[n]] > distance_sq[s->cells[deepest]]))
            deepest = n;
    if (deepest == s->cell_count || (is_single && !s->count))
        return deepest;
    double middle[2], p[2], farthest = -1;
    cwi_cell_middle(s->map, s->cells[deepest], middle);
    for (size_t n = 0; n < s->cell_count; n++) {
        if (s->spacing_sq[n] < 0 || distance_sq[s->cells[n]] < reach_sq)
            continue;
        cwi_cell_middle(s->map, s->cells[n], p);
        const double d = s->count ? s->spacing_sq[n]
                                  : (p[0] - middle[0]) * (p[0] - middle[0]) +
                                        (p[1] - middle[1]) * (p[1] - middle[1]);
        if (d > farthest * (1 + 1e-9)) {
            farthest = d;
            best = n;
        }
    }
    return best;
}

/* Lowers the distances of cells to the nearest peg by a new one. */
static void note_peg(peg_search *s, const double p[2])
{
    for (size_t n = 0; n < s->cell_count; n++) {
        double q[2];
        cwi_cell_middle(s->map, s->cells[n], q);
        s->spacing_sq[n] = cwi_lesser(s->spacing_sq[n], (p[0] - q[0]) * (p[0] - q[0]) +
                                                            (p[1] - q[1]) * (p[1] - q[1]));
    }
}

/* Places up to `wanted` pegs in cells at least so far from blocked ones, each as far as possible from the others. */
static void place_in_cells(peg_search *s, size_t wanted, double reach_cells)
{
    size_t failures = 0;
    s->count = 0;
    for (size_t n = 0; n < s->cell_count; n++)
        s->spacing_sq[n] = INFINITY;
    while (s->count < wanted && failures < MAX_FAILURES) {
        const size_t n = find_cell(s, reach_cells * reach_cells, wanted == 1);
        double p[2];
        if (n == s->cell_count)
            return;
        cwi_cell_middle(s->map, s->cells[n], p);
        if (has_room(s, p, &s->found[s->count])) {
            memcpy(s->places[s->count++], p, sizeof p);
            note_peg(s, p);
        } else
            failures++;
        s->spacing_sq[n] = -1;
    }
}

/* Places pegs in a region: well inside if all have room there, else wherever they have. */
static void place_in_region(peg_search *s, size_t wanted)
{
    const double radius = cwi_peg_room(s->sizes.hole_radius + s->sizes.wall) / s->map->cell;
    double deepest_sq = 0;
    for (size_t n = 0; n < s->cell_count; n++)
        deepest_sq = cwi_greater(deepest_sq, s->map->distance_sq[s->cells[n]]);
    const double any = cwi_greater(radius - CELL_SLACK, 0.5),
                 inner = cwi_greater(any, INNER_FRACTION * sqrt(deepest_sq));
    place_in_cells(s, wanted, inner);
    if (s->count < wanted && inner > any)
        place_in_cells(s, wanted, any);
}

/* --- one section -------------------------------------------------------------------------- */

/* Sorts cells by region. starts: region_count + 2 */
static void list_cells(const cwi_section_map *map, size_t *cells, size_t *starts)
{
    const size_t count = map->nx * map->ny;
    for (size_t n = 0; n < count; n++)
        starts[map->region[n] + 1]++;
    for (size_t r = 0; r <= map->region_count; r++)
        starts[r + 1] += starts[r];
    for (size_t n = 0; n < count; n++)
        cells[starts[map->region[n]]++] = n;
    for (size_t r = map->region_count + 1; r > 0; r--)
        starts[r] = starts[r - 1];
    starts[0] = 0;
}

/* Adds the pegs of a region to all. */
static bool keep_pegs(cwi_cutter *c, const cw_peg *pegs, size_t count, size_t *capacity,
                      size_t section)
{
    cw_pieces *o = c->out;
    for (size_t n = 0; n < count; n++) {
        cw_peg *grown = cwi_grow_array(o->pegs, o->peg_count, capacity, sizeof *grown);
        if (!grown)
            return false;
        o->pegs = grown;
        o->pegs[o->peg_count++] = pegs[n];
        o->shortened += pegs[n].length_mm < o->settings.peg_length_mm;
    }
    o->sections[section].pegs += count;
    o->missing += o->settings.pegs - count;
    return true;
}

/* The arrays of a section's search. */
typedef struct section_search {
    size_t *cells, *starts;
    double *spacing_sq;
    cw_peg *found, *best; /* of a region, then of all regions with the count of each */
    double (*places)[2];
    size_t *counts;
} section_search;

static bool alloc_search(section_search *a, const cwi_section_map *map, size_t pegs)
{
    const size_t cells = map->nx * map->ny;
    a->cells = cwi_alloc_array(cells, sizeof *a->cells);
    a->starts = cwi_alloc_zeroed(map->region_count + 2, sizeof *a->starts);
    a->spacing_sq = cwi_alloc_array(cells, sizeof *a->spacing_sq);
    a->found = cwi_alloc_array(pegs, sizeof *a->found);
    a->best = cwi_alloc_array(map->region_count, pegs * sizeof *a->best);
    a->places = cwi_alloc_array(pegs, sizeof *a->places);
    a->counts = cwi_alloc_zeroed(map->region_count, sizeof *a->counts);
    return a->cells && a->starts && a->spacing_sq && a->found && a->best && a->places &&
           a->counts;
}

static void free_search(section_search *a)
{
    cwi_free(a->cells);
    cwi_free(a->starts);
    cwi_free(a->spacing_sq);
    cwi_free(a->found);
    cwi_free(a->best);
    cwi_free(a->places);
    cwi_free(a->counts);
}

/* Tries pegs of one length in all regions that do not have all of theirs yet. */
static cw_status try_length(cwi_cutter *c, size_t section, cwi_section_map *map, double length,
                            section_search *a, cw_error *err)
{
    const cw_pieces_desc *d = &c->out->settings;
    peg_search s = {.c = c, .map = map, .section = section, .length = length};
    s.sizes = cwi_find_peg_sizes(d, d->peg_diameter_mm, length);
    s.found = a->found;
    s.places = a->places;
    cw_status st = cwi_section_map_measure(map, s.sizes.deep, err);
    for (uint32_t r = 1; r <= map->region_count && st == CW_OK; r++) {
        if (a->counts[r - 1] == d->pegs)
            continue;
        s.region = r;
        s.cells = a->cells + a->starts[r];
        s.spacing_sq = a->spacing_sq + a->starts[r];
        s.cell_count = a->starts[r + 1] - a->starts[r];
        place_in_region(&s, d->pegs);
        if (s.count > a->counts[r - 1]) {
            memcpy(a->best + (r - 1) * d->pegs, s.found, s.count * sizeof *s.found);
            a->counts[r - 1] = s.count;
        }
    }
    return st;
}

static cw_status place_in_section(cwi_cutter *c, size_t n, size_t *capacity, cw_error *err)
{
    const cw_pieces_desc *d = &c->out->settings;
    const cw_piece_section *section = &c->out->sections[n];
    const cwi_peg_sizes longest = cwi_find_peg_sizes(d, d->peg_diameter_mm, d->peg_length_mm);
    cwi_section_map map = {0};
    section_search a = {0};
    cw_status st = cwi_section_map_make(c, section, &map, err);
    if (st == CW_OK)
        st = cwi_section_map_add_surfaces(c, section, longest.deep, &map, err);
    if (st == CW_OK && !alloc_search(&a, &map, d->pegs))
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        list_cells(&map, a.cells, a.starts);
    for (size_t k = 0; k < sizeof length_fractions / sizeof *length_fractions && st == CW_OK;
         k++)
        st = try_length(c, n, &map, length_fractions[k] * d->peg_length_mm, &a, err);
    for (size_t r = 0; r < map.region_count && st == CW_OK; r++)
        if (!keep_pegs(c, a.best + r * d->pegs, a.counts[r], capacity, n))
            st = cwi_fail_memory(err);
    free_search(&a);
    cwi_section_map_free(&map);
    return st;
}

/* --- all sections ------------------------------------------------------------------------- */

/* Finds the largest distance of a point of each section to its border, and counts the regions. */
static cw_status find_widest(cwi_cutter *c, size_t n, double *reach, cw_error *err)
{
    const double nowhere[2] = {0, 0};
    cwi_section_map map = {0};
    cw_piece_section *section = &c->out->sections[n];
    cw_status st = cwi_section_map_make(c, section, &map, err);
    if (st == CW_OK)
        st = cwi_section_map_measure(&map, nowhere, err);
    size_t *deepest =
        st == CW_OK ? cwi_alloc_zeroed(map.region_count + 1, sizeof *deepest) : NULL;
    if (st == CW_OK && !deepest)
        st = cwi_fail_memory(err);
    for (size_t k = 0; k < map.nx * map.ny && st == CW_OK; k++)
        if (map.distance_sq[k] > map.distance_sq[deepest[map.region[k]]])
            deepest[map.region[k]] = k;
    *reach = 0;
    for (uint32_t r = 1; r <= map.region_count && st == CW_OK; r++) {
        double p[2];
        if (!deepest[r])
            continue; /* narrower than a cell */
        cwi_cell_middle(&map, deepest[r], p);
        *reach = cwi_greater(*reach, cwi_leave_border(&map, r, p));
    }
    section->regions = map.region_count;
    cwi_free(deepest);
    cwi_section_map_free(&map);
    return st;
}

/* Fills in the sizes that were not given. reach: the largest of all sections */
static void choose_sizes(cw_pieces_desc *d, double reach)
{
    const double max = d->max_automatic_mm > 0 ? d->max_automatic_mm : 8;
    if (d->peg_diameter_mm == 0)
        d->peg_diameter_mm = fmin(max, FIRST_FRACTION * cwi_widest_peg(d, reach));
    if (d->wall_mm == 0)
        d->wall_mm = CWI_PEG_WALL * d->peg_diameter_mm;
    if (d->peg_length_mm == 0)
        d->peg_length_mm = (d->dowels ? 3 : 1.5) * d->peg_diameter_mm;
}

/* Returns true if smaller pegs are worth a try: a section that is wide enough has none, or one of the widest has
 * fewer than requested. */
static bool are_pegs_crowded(const cw_pieces *o)
{
    double widest = 0;
    for (size_t n = 0; n < o->section_count; n++)
        widest = cwi_greater(widest, o->sections[n].widest_mm);
    for (size_t n = 0; n < o->section_count; n++) {
        const cw_piece_section *s = &o->sections[n];
        if ((!s->pegs && s->widest_mm >= o->settings.peg_diameter_mm) ||
            (s->pegs < o->settings.pegs && s->widest_mm >= WIDE * widest))
            return true;
    }
    return false;
}

/* Places pegs of one size in all sections, in place of those that there are. */
static cw_status place_size(cwi_cutter *c, cw_error *err)
{
    cw_pieces *o = c->out;
    size_t capacity = 0;
    cw_status st = CW_OK;
    cwi_free(o->pegs);
    o->pegs = NULL;
    o->peg_count = o->shortened = o->missing = 0;
    for (size_t n = 0; n < o->section_count; n++)
        o->sections[n].pegs = 0;
    for (size_t n = 0; n < o->section_count && st == CW_OK; n++)
        st = place_in_section(c, n, &capacity, err);
    return st;
}

/* Places pegs; those of a diameter that was not given get smaller while they are in each other's way. asked: the settings without defaults */
static cw_status place_sizes(cwi_cutter *c, const cw_pieces_desc *asked, double widest,
                             cw_error *err)
{
    enum { TRIES = 4 };
    cw_pieces *o = c->out;
    cw_status st = CW_OK;
    for (int n = 0; n < TRIES && st == CW_OK; n++) {
        cw_pieces_desc d = *asked;
        if (n > 0)
            d.peg_diameter_mm = o->settings.peg_diameter_mm * SMALLER;
        choose_sizes(&d, widest);
        o->settings = d;
        if (d.peg_diameter_mm <= 0)
            return CW_OK;
        st = place_size(c, err);
        if (asked->peg_diameter_mm > 0 || !are_pegs_crowded(o))
            break;
    }
    return st;
}

cw_status cwi_place_pegs(cwi_cutter *c, cw_error *err)
{
    cw_pieces *o = c->out;
    double widest = 0;
    cw_status st = CW_OK;
    double *reach = cwi_alloc_zeroed(o->section_count, sizeof *reach);
    if (!reach)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < o->section_count && st == CW_OK; n++) {
        st = find_widest(c, n, &reach[n], err);
        widest = cwi_greater(widest, reach[n]);
    }
    cw_pieces_desc asked = o->settings;
    if (asked.clearance_mm == 0)
        asked.clearance_mm = DEFAULT_CLEARANCE_MM;
    for (size_t n = 0; n < o->section_count; n++)
        o->sections[n].widest_mm = cwi_widest_peg(&asked, reach[n]);
    cwi_free(reach);
    if (st == CW_OK)
        st = place_sizes(c, &asked, widest, err);
    if (st != CW_OK || o->peg_count)
        return st;
    const double room = cwi_widest_peg(&asked, widest);
    if (room <= 0)
        return cwi_fail(
            err, CW_ERR_CHECK,
            "no peg has room: the clearance of %.3g mm takes all of the sections, which have "
            "points %.3g mm from their border at most",
            asked.clearance_mm, widest);
    return cwi_fail(
        err, CW_ERR_CHECK,
        "no peg of %.3g mm and %.3g mm length has room in the %zu section%s: they are wide enough for "
        "%.3g mm, with %.3g mm around the hole, and the material beside them has to be as deep",
        o->settings.peg_diameter_mm, o->settings.peg_length_mm, o->section_count,
        o->section_count == 1 ? "" : "s", room, o->settings.wall_mm);
}
