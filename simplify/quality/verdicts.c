/* Findings into verdicts. A verdict is a few lines that say what is wrong, for whom, and what
 * to do; profiles are columns of grades. */
#include <cubewright/check.h>

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

typedef struct bench {
    const cw_findings *f;
    cw_profile profile;
    int column; /* of grades */
    cw_verdict *verdicts;
    size_t count;
} bench;

/* How bad a fault is for each profile. */
typedef struct severity {
    cw_grade grade[4]; /* basic, print, web and the like, fem */
} severity;

static const severity always = {{CW_GRADE_FAIL, CW_GRADE_FAIL, CW_GRADE_FAIL, CW_GRADE_FAIL}};
static const severity not_for_web = {
    {CW_GRADE_FAIL, CW_GRADE_FAIL, CW_GRADE_WARN, CW_GRADE_FAIL}};
static const severity for_solids = {
    {CW_GRADE_NOTE, CW_GRADE_FAIL, CW_GRADE_NOTE, CW_GRADE_FAIL}};
static const severity for_fem = {{CW_GRADE_NOTE, CW_GRADE_NOTE, CW_GRADE_NOTE, CW_GRADE_FAIL}};
static const severity for_print = {
    {CW_GRADE_NOTE, CW_GRADE_WARN, CW_GRADE_NOTE, CW_GRADE_NOTE}};
static const severity for_web = {{CW_GRADE_NOTE, CW_GRADE_NOTE, CW_GRADE_WARN, CW_GRADE_NOTE}};
static const severity for_solver = {
    {CW_GRADE_NOTE, CW_GRADE_NOTE, CW_GRADE_NOTE, CW_GRADE_WARN}};
static const severity look = {{CW_GRADE_WARN, CW_GRADE_WARN, CW_GRADE_WARN, CW_GRADE_WARN}};
static const severity overlap = {{CW_GRADE_WARN, CW_GRADE_WARN, CW_GRADE_NOTE, CW_GRADE_FAIL}};

/* Returns the column of a profile: what is drawn has one. */
static int find_column(cw_profile profile)
{
    return cw_check_budget(profile) ? CW_PROFILE_WEB : (int)profile;
}

static const char *plural_ending(size_t count)
{
    return count == 1 ? "" : "s";
}

static cw_verdict *add_verdict(bench *b, const char *name, cw_grade grade, double number)
{
    cw_verdict *v = &b->verdicts[b->count++];
    *v = (cw_verdict){.name = name, .grade = grade, .number = number};
    return v;
}

static void say_finding(cw_verdict *v, const char *format, ...) CW_PRINTF(2, 3);
static void say_finding(cw_verdict *v, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(v->text, sizeof v->text, format, args);
    va_end(args);
}

/* A verdict on a count of faults: OK when there is none; then the text says what does hold. */
static cw_verdict *add_count(bench *b, const char *name, const severity *s, size_t count,
                             const char *none, const char *advice)
{
    cw_verdict *v =
        add_verdict(b, name, count ? s->grade[b->column] : CW_GRADE_OK, (double)count);
    say_finding(v, "%s", none);
    v->advice = count ? advice : NULL;
    return v;
}

static void judge_size(bench *b)
{
    const cw_quality *q = b->f->quality;
    if (q->triangles == 0) {
        cw_verdict *v = add_verdict(b, "triangles", CW_GRADE_FAIL, 0);
        say_finding(v, "the mesh has none");
        v->advice = "the file holds no surface: look at what wrote it";
        return;
    }
    if (b->profile != CW_PROFILE_PRINT)
        return;
    double high = 0;
    for (int a = 0; a < 3; a++)
        high = fmax(high, q->max[a] - q->min[a]);
    const bool fits = high >= CW_PRINT_MIN_MM && high <= CW_PRINT_MAX_MM;
    cw_verdict *v =
        add_verdict(b, "size", fits ? CW_GRADE_OK : for_print.grade[b->column], high);
    say_finding(v, "the box is %.6g x %.6g x %.6g mm", q->max[0] - q->min[0],
                q->max[1] - q->min[1], q->max[2] - q->min[2]);
    if (!fits)
        v->advice = "printers make 5 to 400 mm: is the file's unit the millimetre?";
}

/* Solids that touch in edges or points are solids; elements of a solver cannot be. */
static void judge_contacts(bench *b)
{
    const cw_quality *q = b->f->quality;
    const size_t contacts = q->contact_edges + q->contact_vertices;
    if (!contacts)
        return;
    char points[64] = "";
    if (q->contact_vertices)
        snprintf(points, sizeof points, "%s%zu point%s", q->contact_edges ? " and " : "",
                 q->contact_vertices, plural_ending(q->contact_vertices));
    cw_verdict *v = add_count(b, "contacts", &for_solver, contacts, "",
                              "move the solids apart, or into each other and unite them");
    if (q->contact_edges)
        say_finding(v, "solids touch in %zu edge%s%s", q->contact_edges,
                    plural_ending(q->contact_edges), points);
    else
        say_finding(v, "solids touch in %s", points);
}

static void judge_surface(bench *b)
{
    const cw_quality *q = b->f->quality;
    const size_t edges = q->nonmanifold_edges - q->contact_edges,
                 vertices = q->nonmanifold_vertices - q->contact_vertices,
                 bad = edges + vertices;
    cw_verdict *v =
        add_count(b, "manifold", &not_for_web, bad,
                  q->contact_edges + q->contact_vertices
                      ? "every edge has one or two triangles, every vertex one fan, "
                        "but for contacts"
                      : "every edge has one or two triangles, every vertex one fan",
                  "split the mesh where more than one surface meets");
    if (bad)
        say_finding(
            v, "%zu edge%s with more than two triangles, %zu vert%s with more than one fan",
            edges, plural_ending(edges), vertices, vertices == 1 ? "ex" : "ices");
    judge_contacts(b);
    v = add_count(b, "closed", &for_solids, q->open_edges, "no edge is open",
                  "fill the holes; a T-junction or a crack is closed by merging near vertices");
    if (q->open_edges)
        say_finding(v, "%zu open edge%s in %zu loop%s", q->open_edges,
                    plural_ending(q->open_edges), q->border_loops,
                    plural_ending(q->border_loops));
    v = add_count(b, "oriented", &always, q->misoriented_edges,
                  "neighbours agree on what is outside", "flip the triangles that disagree");
    if (q->misoriented_edges)
        say_finding(v, "%zu edge%s between triangles that disagree on what is outside",
                    q->misoriented_edges, plural_ending(q->misoriented_edges));
    if (!q->one_sided)
        return;
    say_finding(
        v,
        "%zu component%s one-sided, like a Moebius strip, and enclose%s no volume: %zu edge%s "
        "between triangles that disagree",
        q->one_sided, q->one_sided == 1 ? " is" : "s are", q->one_sided == 1 ? "s" : "",
        q->misoriented_edges, plural_ending(q->misoriented_edges));
    v->advice = "no orientation fits; cw_mesh_repair() with wrap_mm makes a solid around it";
}

static void judge_shells(bench *b)
{
    const cw_quality *q = b->f->quality;
    cw_verdict *v = add_count(b, "outward", &always, q->inside_out,
                              "every closed shell faces the right way", "flip these shells");
    if (q->inside_out)
        say_finding(v, "%zu closed shell%s inside out", q->inside_out,
                    q->inside_out == 1 ? " is" : "s are");
    if (q->open_inward) {
        v = add_count(b, "facing", &look, q->open_inward, "", "if so, flip them");
        say_finding(v, "%zu open shell%s to be inside out", q->open_inward,
                    q->open_inward == 1 ? " seems" : "s seem");
    }
    if (!q->nested)
        return;
    v = add_count(
        b, "nested", &overlap, q->nested, "",
        "cw_mesh_repair() makes cavities of them; cw_mesh_repair() with outer_only drops them");
    say_finding(v, "%zu shell%s inside another solid, not as a cavity", q->nested,
                q->nested == 1 ? " lies" : "s lie");
}

static void judge_triangles(bench *b)
{
    const cw_quality *q = b->f->quality;
    cw_verdict *v =
        add_count(b, "degenerate", &not_for_web, q->degenerate, "every triangle has an area",
                  "collapse or flip their short edges");
    if (q->degenerate)
        say_finding(v, "%zu triangle%s without area", q->degenerate,
                    plural_ending(q->degenerate));
    if (q->duplicates) {
        v = add_count(b, "duplicates", &not_for_web, q->duplicates, "",
                      "keep one of each, or none where two walls meet");
        say_finding(v, "%zu triangle%s with the vertices of another one", q->duplicates,
                    plural_ending(q->duplicates));
    }
    if (q->unused_vertices) {
        v = add_count(b, "unused", &for_web, q->unused_vertices, "", "drop them");
        say_finding(v, "%zu vert%s in no triangle", q->unused_vertices,
                    q->unused_vertices == 1 ? "ex" : "ices");
    }
}

static void judge_shapes(bench *b)
{
    const cw_quality *q = b->f->quality;
    const cw_shapes *s = &q->shapes;
    if (q->degenerate == q->triangles)
        return;
    const bool good =
        s->min_angle_deg >= CW_FEM_MIN_ANGLE_DEG && s->max_aspect <= CW_FEM_MAX_ASPECT;
    cw_verdict *v = add_verdict(b, "shapes", good ? CW_GRADE_OK : for_fem.grade[b->column],
                                s->min_angle_deg);
    say_finding(
        v,
        "smallest angle %.3g degrees, largest aspect ratio %.3g; %zu needle%s, %zu cap%s, "
        "edges "
        "%.3g to %.3g mm",
        s->min_angle_deg, s->max_aspect, q->needles, plural_ending(q->needles), q->caps,
        plural_ending(q->caps), s->min_edge_mm, s->max_edge_mm);
    if (v->grade == CW_GRADE_FAIL)
        v->advice =
            "remesh, or extract with desc->snap = 0.5: FEM wants 10 degrees and a ratio of 10";
}

bool cw_check_wants_crossings(cw_profile profile)
{
    return for_solids.grade[find_column(profile)] == CW_GRADE_FAIL;
}

static void judge_crossings(bench *b)
{
    const cw_crossings *x = b->f->crossings;
    const bool is_requested = cw_check_wants_crossings(b->profile);
    if (!x || (x->undecided && !x->count)) {
        const cw_grade grade = is_requested || x ? CW_GRADE_UNKNOWN : CW_GRADE_NOTE;
        cw_verdict *v = add_verdict(b, "self-intersections", grade, 0);
        say_finding(v,
                    x ? "undecided: too many triangles are in one place to look at every pair"
                      : "not looked for");
        v->advice =
            x ? "drop the heap of slivers first" : "cw_self_intersections() looks for them";
        return;
    }
    cw_verdict *v = add_count(b, "self-intersections", &not_for_web, x->count,
                              "no two triangles meet but where they are neighbours",
                              "separate or unite the parts that cross");
    if (x->count)
        say_finding(v, "%s%zu pair%s of triangles meet%s that should not",
                    x->undecided ? "at least " : "", x->count, plural_ending(x->count),
                    x->count == 1 ? "s" : "");
}

/* A verdict on an area with thin walls or narrow gaps. */
static void judge_width(bench *b, const char *name, const char *one, double min_mm,
                        const double at[3], double below_mm2, double limit, const char *advice)
{
    const double percent = 100 * below_mm2 / b->f->print->area_mm2;
    cw_verdict *v =
        add_verdict(b, name, below_mm2 > 0 ? CW_GRADE_WARN : CW_GRADE_OK, below_mm2);
    if (below_mm2 > 0) {
        say_finding(v,
                    "%.3g mm2 (%.2g %%) of the surface is at %ss below %g mm; the least is "
                    "%.3g mm, at %.6g, %.6g, %.6g",
                    below_mm2, percent, one, limit, min_mm, at[0], at[1], at[2]);
        v->advice = advice;
    } else if (isfinite(min_mm))
        say_finding(v, "no %s is below %g mm; the least is %.4g mm, at %.6g, %.6g, %.6g", one,
                    limit, min_mm, at[0], at[1], at[2]);
    else
        say_finding(v, "no %s is below %g mm", one, limit);
}

/* Tells what another side down would change. */
static void judge_orientation(bench *b)
{
    const cw_orient_facts *o = b->f->orient;
    if (!o)
        return;
    const double saved = o->before.overhang_mm2 - o->after.overhang_mm2;
    cw_verdict *v =
        add_verdict(b, "orientation", o->is_kept ? CW_GRADE_OK : CW_GRADE_NOTE, saved);
    if (o->is_kept) {
        say_finding(v, "none of %zu poses prints with less support", o->poses);
        return;
    }
    say_finding(
        v,
        "%.3g %.3g %.3g up: overhangs %.4g mm2, height %.4g mm (now %.4g), tips over at %.3g "
        "degrees (now %.3g); cw_orient_print() turns it",
        o->after.up[0], o->after.up[1], o->after.up[2], o->after.overhang_mm2,
        o->after.height_mm, o->before.height_mm, o->after.tip_deg, o->before.tip_deg);
}

static void judge_support(bench *b)
{
    const cw_print_facts *p = b->f->print;
    cw_verdict *v = add_verdict(b, "overhangs", CW_GRADE_NOTE, p->overhang_mm2);
    say_finding(
        v, "%.4g mm2 (%.2g %%) of the surface leans more than %g degrees from the vertical",
        p->overhang_mm2, 100 * p->overhang_mm2 / p->area_mm2, p->limits.overhang_deg);
    judge_orientation(b);
    v = add_verdict(b, "islands", p->islands ? CW_GRADE_WARN : CW_GRADE_OK, (double)p->islands);
    if (!p->islands) {
        say_finding(v, "nothing begins in the air");
        return;
    }
    say_finding(v, "%zu part%s in the air; the tallest at %.6g, %.6g, %.6g", p->islands,
                p->islands == 1 ? " begins" : "s begin", p->island_at[0], p->island_at[1],
                p->island_at[2]);
    v->advice = "supports hold them, or another side down";
}

static void judge_stand(bench *b)
{
    const cw_print_facts *p = b->f->print;
    const cw_quality *q = b->f->quality;
    const bool stands = p->margin_mm > 0;
    double at[3];
    for (int a = 0; a < 3; a++) /* without digits that are rounding alone */
        at[a] = fabs(p->center[a]) < 1e-6 * (q->max[a] - q->min[a]) ? 0 : p->center[a];
    cw_verdict *v =
        add_verdict(b, "stability", stands ? CW_GRADE_OK : CW_GRADE_WARN, p->tip_deg);
    if (stands)
        say_finding(v,
                    "stands on %.4g mm2, and tips over at %.3g degrees; the centre of mass is "
                    "at %.6g, %.6g, %.6g",
                    p->foot_mm2, p->tip_deg, at[0], at[1], at[2]);
    else {
        say_finding(v,
                    "tips over as it stands, on %.4g mm2; the centre of mass is at %.6g, %.6g, "
                    "%.6g",
                    p->foot_mm2, at[0], at[1], at[2]);
        v->advice = "turn it, support it, or cut a flat base";
    }
    if (p->limits.plate_mm[0] == 0)
        return;
    v = add_verdict(b, "plate", p->fits ? CW_GRADE_OK : CW_GRADE_FAIL, 0);
    say_finding(v, "%s a plate of %g x %g x %g mm", p->fits ? "fits" : "does not fit",
                p->limits.plate_mm[0], p->limits.plate_mm[1], p->limits.plate_mm[2]);
    v->advice = p->fits ? NULL : "print it smaller, turned, or in pieces";
}

static void judge_print(bench *b)
{
    const cw_print_facts *p = b->f->print;
    if (!p || !(p->area_mm2 > 0))
        return;
    judge_width(b, "walls", "wall", p->wall_mm, p->wall_at, p->thin_mm2, p->limits.min_wall_mm,
                "print it larger, or let cw_mesh_offset() grow it");
    judge_width(b, "gaps", "gap", p->gap_mm, p->gap_at, p->narrow_mm2, p->limits.min_gap_mm,
                "they may close in print");
    judge_support(b);
    cw_verdict *v =
        add_verdict(b, "trapped", p->trapped ? CW_GRADE_WARN : CW_GRADE_OK, p->trapped_mm3);
    if (p->trapped) {
        say_finding(v, "%zu closed cavit%s of %.4g mm3", p->trapped,
                    p->trapped == 1 ? "y" : "ies", p->trapped_mm3);
        v->advice = "cw_mesh_fill_voids() fills them; else resin and powder stay inside";
    } else
        say_finding(v, "no closed cavity");
    judge_stand(b);
}

static void judge_file_size(bench *b, const cw_budget *budget)
{
    const size_t bytes = b->f->file_bytes;
    const bool much = bytes > budget->file_bytes;
    cw_verdict *v =
        add_verdict(b, "file size", much ? CW_GRADE_WARN : CW_GRADE_OK, (double)bytes);
    say_finding(v, "%.3g MB; the profile's budget is %.3g MB", (double)bytes / 1e6,
                (double)budget->file_bytes / 1e6);
    if (much)
        v->advice = "compress it, or use smaller textures";
}

static void judge_look(bench *b)
{
    const cw_quality *q = b->f->quality;
    const cw_budget *budget = cw_check_budget(b->profile);
    if (!budget)
        return;
    const bool many = q->triangles > budget->triangles[0];
    cw_verdict *v =
        add_verdict(b, "weight", many ? CW_GRADE_WARN : CW_GRADE_OK, (double)q->triangles);
    say_finding(v, "%zu triangles; the profile's budget is %zu", q->triangles,
                budget->triangles[0]);
    if (many)
        v->advice = "reduce the mesh: detail beyond that belongs into a normal map";
    if (b->f->file_bytes)
        judge_file_size(b, budget);
    if (b->f->file_fault && *b->f->file_fault) {
        v = add_verdict(b, "file", CW_GRADE_FAIL, 1);
        say_finding(v, "%s", b->f->file_fault);
        v->advice = "write it again: viewers may show it wrong, or not at all";
    }
    v = add_verdict(b, "normals", b->f->has_normals ? CW_GRADE_OK : CW_GRADE_WARN, 0);
    say_finding(v,
                b->f->has_normals ? "one at every vertex" : "none: viewers will shade it flat");
}

/* There, and back: the mesh may be near all of it and yet leave parts of it out. */
static void judge_distance(bench *b, const char *name, const char *other, const cw_distance *to,
                           const char *rest, const cw_distance *back)
{
    if (!to)
        return;
    const double tolerance = b->f->tolerance_mm;
    const double far = fmax(to->max_mm, to->bound_mm);
    const bool holds = far <= tolerance;
    cw_verdict *v = add_verdict(
        b, name, tolerance > 0 ? (holds ? CW_GRADE_OK : CW_GRADE_FAIL) : CW_GRADE_NOTE, far);
    say_finding(
        v, "at most %.4g mm from %s, rms %.3g, 99 %% within %.3g; farthest at %.8g, %.8g, %.8g",
        to->max_mm, other, to->rms_mm, to->p99_mm, to->where[0], to->where[1], to->where[2]);
    if (v->grade == CW_GRADE_FAIL)
        v->advice = "beyond the tolerance: cw_check_paint() shows where";
    if (!back)
        return;
    const bool covers = fmax(back->max_mm, back->bound_mm) <= tolerance;
    v = add_verdict(b, "covered",
                    !(tolerance > 0) ? CW_GRADE_NOTE
                    : covers         ? CW_GRADE_OK
                                     : CW_GRADE_FAIL,
                    back->max_mm);
    say_finding(
        v, "%s is at most %.4g mm from the mesh, rms %.3g; farthest at %.8g, %.8g, %.8g", rest,
        back->max_mm, back->rms_mm, back->where[0], back->where[1], back->where[2]);
}

/* Judges pictures of the mesh beside the same pictures of the reference. */
static void judge_looks(bench *b)
{
    const cw_findings *f = b->f;
    const cw_appearance *looks = f->looks;
    if (!looks)
        return;
    const bool is_limited = f->max_delta_e > 0 || f->min_psnr_db > 0;
    const bool holds = !(f->max_delta_e > 0 && looks->all.delta_e > f->max_delta_e) &&
                       !(f->min_psnr_db > 0 && looks->all.psnr_db < f->min_psnr_db);
    cw_verdict *v = add_verdict(b, "looks",
                                !is_limited ? CW_GRADE_NOTE
                                : holds     ? CW_GRADE_OK
                                            : CW_GRADE_FAIL,
                                looks->all.delta_e);
    char bare[64] = "", psnr[32] = "equal";
    if (f->bare_looks)
        snprintf(bare, sizeof bare, " (%.2f without maps)", f->bare_looks->all.delta_e);
    if (isfinite(looks->all.psnr_db))
        snprintf(psnr, sizeof psnr, "PSNR %.2f dB", looks->all.psnr_db);
    say_finding(v, "%s, CIEDE2000 %.2f%s; inside both outlines %.2f; %u views", psnr,
                looks->all.delta_e, bare, looks->all.delta_e_both, looks->views);
    if (v->grade == CW_GRADE_FAIL)
        v->advice = "keep more triangles, or bake a normal map of the reference";
}

/* Components that were left out, such as specks: no distance of what is there. */
static void judge_missing(bench *b)
{
    const cw_findings *f = b->f;
    if (!f->missing)
        return;
    cw_verdict *v = add_verdict(
        b, "missing", f->tolerance_mm > 0 ? CW_GRADE_FAIL : CW_GRADE_WARN, (double)f->missing);
    say_finding(
        v,
        "%zu component%s of the field's surface %s no counterpart; the largest encloses %.4g "
        "mm3, and %s up to %.4g mm from the mesh",
        f->missing, plural_ending(f->missing), f->missing == 1 ? "has" : "have", f->missing_mm3,
        f->missing == 1 ? "it is" : "they are", f->missing_mm);
    v->advice = "cw_mesh_drop_volumes() leaves small ones out of the comparison";
}

static void judge_topology(bench *b)
{
    const cw_quality *q = b->f->quality, *t = b->f->field;
    if (!t)
        return;
    const bool same = q->components == t->components && q->euler == t->euler &&
                      q->border_loops == t->border_loops;
    cw_verdict *v = add_verdict(b, "topology", same ? CW_GRADE_OK : look.grade[b->column],
                                fabs((double)q->components - (double)t->components));
    if (same)
        say_finding(v, "as the field's: %zu component%s, Euler number %lld, %zu border loop%s",
                    q->components, plural_ending(q->components), (long long)q->euler,
                    q->border_loops, plural_ending(q->border_loops));
    else
        say_finding(
            v,
            "not the field's: %zu component%s where it has %zu, Euler number %lld not %lld, "
            "%zu "
            "border loops not %zu",
            q->components, plural_ending(q->components), t->components, (long long)q->euler,
            (long long)t->euler, q->border_loops, t->border_loops);
}

/* Where CGAL takes the mesh, it must say what we say. */
static void judge_agreement(bench *b)
{
    const cw_quality *q = b->f->quality;
    const cw_cgal_facts *c = b->f->cgal;
    const cw_crossings *x = b->f->crossings;
    if (!c)
        return;
    const bool manifold =
        !q->nonmanifold_edges && !q->nonmanifold_vertices && !q->misoriented_edges;
    const char *differs = NULL;
    if (c->is_polygon_mesh != manifold)
        differs = "whether it is an oriented manifold";
    else if (manifold && c->closed != !q->open_edges)
        differs = "whether it is closed";
    else if (manifold && c->border_loops != q->border_loops)
        differs = "the border's loops";
    else if (manifold && c->components != q->components)
        differs = "the components";
    else if (manifold && x && !x->undecided && c->self_intersections != x->count)
        differs = "the self-intersections";
    else if (manifold && c->bounds_volume && (q->inside_out || q->nested) && c->outward)
        differs = "which way shells face";
    cw_verdict *v = add_verdict(b, "cgal", differs ? CW_GRADE_FAIL : CW_GRADE_OK, 0);
    if (differs)
        say_finding(v, "CGAL and these checks differ on %s", differs);
    else
        say_finding(v, manifold ? "CGAL says the same" : "CGAL takes no such mesh either");
    v->advice = differs ? "one of the two is wrong: please report it" : NULL;
}

/* Worst first, and as judged among equals: an insertion sort keeps their order. */
static void sort_verdicts(cw_verdict *v, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        const cw_verdict x = v[i];
        size_t j = i;
        for (; j > 0 && v[j - 1].grade > x.grade; j--)
            v[j] = v[j - 1];
        v[j] = x;
    }
}

const cw_budget *cw_check_budget(cw_profile profile)
{
    static const cw_budget budgets[] = {
        [CW_PROFILE_WEB] = {{100000}, 1024, 5000000},
        [CW_PROFILE_GAME] = {{10000, 5000, 2500}, 2048, 16000000},
        [CW_PROFILE_MOBILE] = {{5000, 2500, 1250}, 1024, 3000000},
    };
    const size_t count = sizeof budgets / sizeof *budgets;
    return (unsigned)profile < count && budgets[profile].file_bytes ? &budgets[profile] : NULL;
}

size_t cw_check_judge(const cw_findings *findings, cw_profile profile,
                      cw_verdict verdicts[CW_MAX_VERDICTS])
{
    if (!findings || !verdicts)
        return 0;
    bench b = {.f = findings,
               .profile = profile,
               .column = find_column(profile),
               .verdicts = verdicts};
    judge_size(&b);
    judge_surface(&b);
    judge_shells(&b);
    judge_crossings(&b);
    judge_triangles(&b);
    judge_shapes(&b);
    judge_print(&b);
    judge_look(&b);
    judge_topology(&b);
    judge_missing(&b);
    judge_distance(&b, "to field", "the field's surface", findings->to_field,
                   findings->missing ? "the rest of the field's surface"
                                     : "the field's surface",
                   findings->from_field);
    judge_distance(&b, "to reference", "the reference", findings->to_reference, "the reference",
                   findings->from_reference);
    judge_looks(&b);
    judge_agreement(&b);
    sort_verdicts(verdicts, b.count);
    return b.count;
}

bool cw_check_holds(const cw_verdict *verdicts, size_t count)
{
    if (!verdicts && count > 0)
        return false;
    for (size_t n = 0; n < count; n++)
        if (verdicts[n].grade == CW_GRADE_FAIL || verdicts[n].grade == CW_GRADE_UNKNOWN)
            return false;
    return true;
}

const char *cw_grade_name(cw_grade grade)
{
    static const char *const names[] = {"fail", "unknown", "warn", "ok", "note"};
    return grade <= CW_GRADE_NOTE ? names[grade] : "unknown";
}
