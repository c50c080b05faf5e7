/* The recipe: the stages in the order in which they run, and which of them go together. A new stage
 * is a row here, a row at the end of CW_STAGE_TABLE, and a function. */
#include "extract/pipeline/stages.h"

#include "core/base/status.h"

static bool wants_views(const cw_pipeline_desc *d)
{
    return d->view_count > 0;
}

static bool wants_surface(const cw_pipeline_desc *d)
{
    (void)d;
    return true;
}

static bool wants_min_volume(const cw_pipeline_desc *d)
{
    return d->min_volume_mm3 > 0;
}

static bool wants_largest(const cw_pipeline_desc *d)
{
    return d->largest > 0;
}

static bool wants_voids_filled(const cw_pipeline_desc *d)
{
    return d->fill_voids;
}

static bool wants_handles_closed(const cw_pipeline_desc *d)
{
    return d->close_handles != NULL;
}

static bool wants_smoothing(const cw_pipeline_desc *d)
{
    return d->smooth != NULL;
}

static bool wants_cut(const cw_pipeline_desc *d)
{
    return d->cut != NULL;
}

static bool wants_text(const cw_pipeline_desc *d)
{
    return d->engrave != NULL;
}

static bool wants_simplification(const cw_pipeline_desc *d)
{
    return d->simplify != NULL;
}

static bool wants_culling(const cw_pipeline_desc *d)
{
    return d->cull;
}

static bool wants_levels(const cw_pipeline_desc *d)
{
    return d->lod_count > 0;
}

static bool wants_normals(const cw_pipeline_desc *d)
{
    return !d->extract.no_normals;
}

static bool wants_color(const cw_pipeline_desc *d)
{
    return d->color != NULL;
}

static bool wants_atlas(const cw_pipeline_desc *d)
{
    return d->atlas != NULL;
}

static bool wants_maps(const cw_pipeline_desc *d)
{
    return d->bake != NULL;
}

static bool wants_creases(const cw_pipeline_desc *d)
{
    return !d->extract.no_normals && (d->crease_degrees > 0 || d->crease_caps);
}

static bool wants_check(const cw_pipeline_desc *d)
{
    return d->check;
}

/* Short names for the table. */
enum {
    WHOLE = CWI_WHOLE_MESH,
    SPOOL = CWI_SPOOL,
    VOXELS = CWI_VOXELS,
    CLOSED = CWI_CLOSED,
    LABELS = CWI_ON_LABELS,
    PARTS = CWI_ON_PARTS,
    NORMALS = CWI_FIELD_NORMALS,
    OPEN = CWI_CLOSEDNESS,
    REDUCED = CWI_OR_REDUCED,
};

/* clang-format off */
const cwi_stage cwi_recipe[CW_STAGE_COUNT] = {
    /* stage              is wanted             needs           spoils   finishes  function */
    {CW_STAGE_VIEWS,      wants_views,          VOXELS,         0,       false, cwi_draw_views},
    {CW_STAGE_EXTRACT,    wants_surface,        LABELS | PARTS, 0,       false, cwi_extract_surface},
    {CW_STAGE_MIN_VOLUME, wants_min_volume,     SPOOL | PARTS,  0,       false, cwi_drop_small},
    {CW_STAGE_LARGEST,    wants_largest,        WHOLE,          0,       false, cwi_keep_largest},
    {CW_STAGE_FILL_VOIDS, wants_voids_filled,   WHOLE,          0,       false, cwi_fill_voids},
    {CW_STAGE_HANDLES,    wants_handles_closed, WHOLE | CLOSED, NORMALS, false, cwi_close_handles},
    {CW_STAGE_SMOOTH,     wants_smoothing,      WHOLE | CLOSED, NORMALS, false, cwi_smooth},
    {CW_STAGE_CUT,        wants_cut,            WHOLE | CLOSED, NORMALS, false, cwi_cut_surface},
    {CW_STAGE_ENGRAVE,    wants_text,           WHOLE | CLOSED, NORMALS, false, cwi_engrave_surface},
    {CW_STAGE_SIMPLIFY,   wants_simplification, LABELS,         0,       false, cwi_simplify_surface},
    {CW_STAGE_CULL,       wants_culling,        WHOLE | VOXELS, OPEN,    false, cwi_cull_surface},
    {CW_STAGE_LOD,        wants_levels,         WHOLE | LABELS, 0,       false, cwi_make_levels},
    {CW_STAGE_ATLAS,      wants_atlas,          WHOLE,          0,       false, cwi_lay_flat},
    {CW_STAGE_NORMALS,    wants_normals,        LABELS | PARTS, 0,       true,  cwi_add_normals},
    {CW_STAGE_CREASES,    wants_creases,        WHOLE | REDUCED | LABELS, 0, true,   cwi_part_normals},
    {CW_STAGE_COLOR,      wants_color,          WHOLE,          0,       true,  cwi_color_surface},
    {CW_STAGE_MAPS,       wants_maps,           WHOLE,          0,       true,  cwi_bake_maps},
    {CW_STAGE_CHECK,      wants_check,          LABELS | PARTS, 0,       true,  cwi_check_surface},
};
/* clang-format on */

static const char *const names[CW_STAGE_COUNT] = {
#define CW_X(name, text) text,
    CW_STAGE_TABLE(CW_X)
#undef CW_X
};

const char *cw_stage_name(cw_stage stage)
{
    return (unsigned)stage < CW_STAGE_COUNT ? names[stage] : NULL;
}

unsigned cw_pipeline_stages(const cw_pipeline_desc *desc)
{
    unsigned stages = 0;
    for (const cwi_stage *s = cwi_recipe;
         desc && desc->version == 0 && s < cwi_recipe + CW_STAGE_COUNT; s++)
        stages |= s->is_wanted(desc) ? 1u << s->stage : 0;
    return stages;
}

/* Returns the row of a stage. */
static const cwi_stage *find_row(cw_stage stage)
{
    const cwi_stage *s = cwi_recipe;
    while (s->stage != stage)
        s++;
    return s;
}

unsigned cwi_spoils(const cw_pipeline_desc *desc)
{
    const unsigned stages = cw_pipeline_stages(desc);
    unsigned spoils = 0;
    for (const cwi_stage *s = cwi_recipe; s < cwi_recipe + CW_STAGE_COUNT; s++)
        spoils |= stages >> s->stage & 1 ? s->spoils : 0;
    return spoils;
}

bool cwi_needs_whole(const cw_pipeline_desc *desc)
{
    const unsigned stages = cw_pipeline_stages(desc);
    bool needs = false;
    for (const cwi_stage *s = cwi_recipe; s->stage != CW_STAGE_SIMPLIFY; s++)
        needs = needs || (stages >> s->stage & 1 && s->needs & (WHOLE | SPOOL));
    return needs;
}

/* --- rules ---------------------------------------------------------------------------------- */

/* Returns why a source excludes a stage; NULL: it does not. */
static const char *find_objection(cw_surface_source source, cw_stage stage, unsigned stages)
{
    const unsigned needs = find_row(stage)->needs;
    const bool in_pieces = source == CW_SOURCE_SLICES || source == CW_SOURCE_PARTS;
    const bool is_reduced =
        source == CW_SOURCE_SLICES && needs & REDUCED && stages & 1u << CW_STAGE_SIMPLIFY;
    if (source == CW_SOURCE_LABELS && !(needs & LABELS))
        return "is for a single surface; labels share their interfaces";
    if (source == CW_SOURCE_SLICES && needs & SPOOL && stages & 1u << CW_STAGE_SIMPLIFY)
        return "beside simplify needs the whole surface in memory";
    if (in_pieces && needs & WHOLE && !is_reduced)
        return "needs the whole surface in memory";
    if (in_pieces && needs & VOXELS)
        return "needs all voxels in memory";
    if (source == CW_SOURCE_MESH && needs & VOXELS)
        return "needs the voxels of a surface";
    return source == CW_SOURCE_PARTS && !(needs & PARTS)
               ? "is for the whole surface; join the parts before"
               : NULL;
}

cw_status cw_pipeline_check(cw_surface_source source, unsigned stages, cw_stage *first,
                            cw_stage *second, cw_error *err)
{
    cw_stage own[2];
    CWI_REQUIRE(err);
    first = first ? first : &own[0];
    second = second ? second : &own[1];
    for (int s = 0; s < CW_STAGE_COUNT; s++) {
        const char *why = stages >> s & 1 ? find_objection(source, (cw_stage)s, stages) : NULL;
        *first = *second = (cw_stage)s;
        if (why && find_row((cw_stage)s)->needs & SPOOL && source == CW_SOURCE_SLICES)
            *second = CW_STAGE_SIMPLIFY;
        if (why)
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s %s", names[s], why);
    }
    for (const cwi_stage *s = cwi_recipe; s < cwi_recipe + CW_STAGE_COUNT; s++)
        for (const cwi_stage *t = cwi_recipe; t < cwi_recipe + CW_STAGE_COUNT; t++)
            if (stages >> s->stage & 1 && stages >> t->stage & 1 && s->needs & CLOSED &&
                t->spoils & OPEN) {
                *first = t->stage;
                *second = s->stage;
                return cwi_fail(err, CW_ERR_ARGUMENT,
                                "%s cannot be combined with %s, which needs a closed surface",
                                names[*first], names[*second]);
            }
    if (stages & 1u << CW_STAGE_LOD &&
        stages & (1u << CW_STAGE_SIMPLIFY | 1u << CW_STAGE_VIEWS)) {
        *first = CW_STAGE_LOD;
        *second = stages & 1u << CW_STAGE_VIEWS ? CW_STAGE_VIEWS : CW_STAGE_SIMPLIFY;
        return cwi_fail(err, CW_ERR_ARGUMENT, "lod simplifies by itself, without %s",
                        names[*second]);
    }
    return CW_OK;
}
