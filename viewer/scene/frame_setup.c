/* Fills in a scene's defaults, and computes the frame: camera, matrices, clip planes and
 * depths. */
#include "viewer/scene/frame_setup.h"

#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"
#include "viewer/scene/cells_size.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_SIZE = 16384, MAX_SAMPLES = 4, MAX_SIGMA = 16, MESH_UNITS = 256 };

/* Narrower blobs leave holes between voxels; wider ones cover thousands of samples. */
static const double MIN_SPLAT_WIDTH = 0.2, MAX_SPLAT_WIDTH = 4;

/* A Gaussian of 0.6 voxels is just so wide that the sum of footprints on a lattice varies by
 * less than 0.6 %. */
static const double splat_widths[CW_SPLAT_COUNT] = {[CW_SPLAT_GAUSSIAN] = 0.6,
                                                    [CW_SPLAT_POLYGON] = 0.6,
                                                    [CW_SPLAT_TENT] = CWI_TENT_WIDTH,
                                                    [CW_SPLAT_B_SPLINE] = CWI_B_SPLINE_WIDTH};

static bool is_camera_set(const cw_camera *c)
{
    return c->up[0] != 0 || c->up[1] != 0 || c->up[2] != 0;
}

static bool is_material_set(const cw_material *m)
{
    return m->ambient != 0 || m->diffuse != 0 || m->specular != 0 || m->shininess != 0;
}

static bool draws_volume(cw_mode mode)
{
    return mode != CW_MODE_MESH;
}

static void set_defaults(cw_scene *s)
{
    static const cw_light headlight = {{0, 0, 1}, {1, 1, 1}};
    static const float bone[4] = {240 / 255.0f, 229 / 255.0f, 208 / 255.0f, 1}, none[4] = {0};
    if (s->width == 0 && s->height == 0) {
        s->width = 1280;
        s->height = 720;
    }
    if (s->samples == 0)
        s->samples = 1;
    if (s->light_count == 0)
        s->lights[s->light_count++] = headlight;
    if (!is_material_set(&s->material))
        s->material = (cw_material){0.25f, 0.75f, 0.2f, 32};
    if (s->sampling.step_vox == 0)
        s->sampling.step_vox = 1;
    if (s->sampling.stop_opacity == 0)
        s->sampling.stop_opacity = s->mode == CW_MODE_VBUFFER ? 0.99999f : 0.9999f;
    if (s->cue_range[0] == 0 && s->cue_range[1] == 0)
        s->cue_range[1] = 1;
    if (s->splat.width == 0 && (unsigned)s->splat.kernel < CW_SPLAT_COUNT)
        s->splat.width = splat_widths[s->splat.kernel];
    if (s->texture.normals == 0)
        s->texture.normals = 1024;
    if (memcmp(s->mesh_look.color, none, sizeof none) == 0)
        memcpy(s->mesh_look.color, bone, sizeof bone);
}

/* Checks each number against its range. */
static cw_status check_ranges(const cw_scene *s, cw_error *err)
{
    const float *color = s->mesh_look.color;
    const struct {
        const char *name;
        double value, min, max;
    } rows[] = {
        {"width", (double)s->width, 1, MAX_SIZE},
        {"height", (double)s->height, 1, MAX_SIZE},
        {"samples", s->samples, 1, MAX_SAMPLES},
        {"light_count", (double)s->light_count, 0, CW_MAX_LIGHTS},
        {"clip_count", (double)s->clip_count, 0, CW_MAX_CLIPS},
        {"slice_count", (double)s->slice_count, 0, CW_MAX_SLICES},
        {"shadow", s->shadow, 0, CW_SHADOW_COUNT - 1},
        {"gradient_sigma", s->gradient_sigma, 0, MAX_SIGMA},
        {"cue_form", s->cue_form, 0, CW_CUE_COUNT - 1},
        {"depth_cue", (double)s->depth_cue, 0, 1},
        {"sampling.step_vox", s->sampling.step_vox, 1e-3, 1e3},
        {"sampling.stop_opacity", (double)s->sampling.stop_opacity, 0, 1},
        {"texture.direction_filter", s->texture.direction_filter, 0, CW_DIRECTIONS_COUNT - 1},
        {"projection.tree_error", s->projection.tree_error, 0, 1},
        {"splat.tree_error", s->splat.tree_error, 0, 1},
        {"splat.kernel", s->splat.kernel, 0, CW_SPLAT_COUNT - 1},
        {"splat.width", s->splat.width, MIN_SPLAT_WIDTH, MAX_SPLAT_WIDTH},
        {"mesh_look.color[0]", (double)color[0], 0, 1},
        {"mesh_look.color[1]", (double)color[1], 0, 1},
        {"mesh_look.color[2]", (double)color[2], 0, 1},
        {"mesh_look.color[3]", (double)color[3], 0, 1},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        if (!(rows[n].value >= rows[n].min && rows[n].value <= rows[n].max))
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s is %g; expected %g to %g", rows[n].name,
                            rows[n].value, rows[n].min, rows[n].max);
    return CW_OK;
}

static cw_status check_cue(const cw_scene *s, cw_error *err)
{
    if (s->cue_form == CW_CUE_EXPONENTIAL && !(s->depth_cue < 1))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "depth_cue is %g; an exponential one must be less than 1",
                        (double)s->depth_cue);
    if (!(s->cue_range[0] < s->cue_range[1] && isfinite(s->cue_range[0]) &&
          isfinite(s->cue_range[1])))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "cue_range is %g to %g; expected two rising fractions", s->cue_range[0],
                        s->cue_range[1]);
    return CW_OK;
}

/* Sets defaults, and checks what modes have in common. */
static cw_status resolve_scene(cw_scene *s, cw_error *err)
{
    if ((unsigned)s->mode >= CW_MODE_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a render mode (0 to %d)", (int)s->mode,
                        CW_MODE_COUNT - 1);
    if (draws_volume(s->mode) && !(s->volume && s->transfer))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s needs a volume and a transfer function",
                        cw_mode_name(s->mode));
    if (!draws_volume(s->mode) && !s->mesh)
        return cwi_fail(err, CW_ERR_ARGUMENT, "the mode mesh needs a mesh");
    set_defaults(s);
    cw_status st = check_ranges(s, err);
    return st == CW_OK ? check_cue(s, err) : st;
}

/* Replaces the mode reference by the intensity projection whose exact picture is requested. */
static cw_status choose_reference(cwi_frame *f, cw_error *err)
{
    const cw_mode of = f->scene.reference_of;
    f->is_reference = f->scene.mode == CW_MODE_REFERENCE;
    if (!f->is_reference || of == (cw_mode)0)
        return CW_OK;
    if (!cw_mode_is_intensity(of))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a reference of the mode %s: an intensity projection was expected",
                        (unsigned)of < CW_MODE_COUNT ? cw_mode_name(of) : "?");
    f->scene.mode = of;
    return CW_OK;
}

/* Finds the box of an even or rectilinear grid in index space, and the smallest spacing. */
static void find_box(cwi_frame *f)
{
    double spacing[3];
    cw_volume_spacing(&f->volume, spacing);
    f->unit_mm = fmin(fmin(spacing[0], spacing[1]), spacing[2]);
    for (int a = 0; a < 3; a++) {
        const size_t n = f->volume.dim[a];
        const double *at = f->volume.coordinates[a];
        const double low = at ? at[0] : 0, high = at ? at[n - 1] : (double)n - 1;
        f->low[a] = n == 1 ? low - 0.5 : low;
        f->high[a] = n == 1 ? high + 0.5 : high;
    }
}

/* Finds the box of an irregular grid, and the edge of its mean cell. */
static cw_status find_cells(cwi_frame *f, cw_error *err)
{
    cwi_cells_size size;
    double longest = 0;
    cw_status st = cwi_cells_measure(&f->volume, f->scene.threads, &size, err);
    if (st != CW_OK)
        return st;
    memcpy(f->low, size.low, sizeof f->low);
    memcpy(f->high, size.high, sizeof f->high);
    for (int a = 0; a < 3; a++)
        longest = fmax(longest, size.high[a] - size.low[a]);
    const double scale = cbrt(fabs(cwi_affine_determinant(f->volume.affine[0])));
    f->unit_mm = scale * cbrt(size.volume / size.boxes);
    if (!isnormal(f->unit_mm)) /* cells without volume */
        f->unit_mm = scale * longest / MESH_UNITS;
    if (!isnormal(f->unit_mm))
        f->unit_mm = 1;
    return CW_OK;
}

/* Refuses modes that draw evenly spaced volumes alone, for a grid of another kind. */
static cw_status check_kind(const cwi_frame *f, cw_error *err)
{
    const char *kind = cwi_volume_kind(&f->volume);
    char list[256];
    size_t used = 0;
    if (cw_mode_draws(f->scene.mode, &f->volume))
        return CW_OK;
    if (f->volume.sparse)
        return cwi_volume_expect_even(&f->volume, "drawing", err);
    for (int m = CW_MODE_MESH + 1; m < CW_MODE_COUNT; m++)
        if (cw_mode_draws((cw_mode)m, &f->volume))
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "",
                                     cw_mode_name((cw_mode)m));
    return cwi_fail(err, CW_ERR_UNSUPPORTED,
                    "the mode %s draws evenly spaced volumes; %s is drawn by %s",
                    cw_mode_name(f->scene.mode), kind, list);
}

static cw_status take_volume(cwi_frame *f, cw_error *err)
{
    cw_status st = cw_volume_resolve(f->scene.volume, &f->volume, err);
    if (st == CW_OK)
        st = check_kind(f, err);
    if (st == CW_OK)
        st = cw_transfer_check(f->scene.transfer, err);
    if (st == CW_OK && f->volume.cells)
        st = find_cells(f, err);
    else if (st == CW_OK)
        find_box(f);
    if (st != CW_OK)
        return st;
    f->transfer = *f->scene.transfer;
    f->opacity_units = f->transfer.unit_mm > 0 ? f->transfer.unit_mm / f->unit_mm : 1;
    f->gradient_volume = f->volume;
    if (f->transfer.index_count > 0)
        f->surface = f->transfer.surface_mm > 0 ? f->transfer.surface_mm / f->unit_mm : 2;
    return CW_OK;
}

/* Computes a corner of the volume's box in the world. */
static void box_corner(const cwi_frame *f, int n, double world[3])
{
    double p[3];
    for (int a = 0; a < 3; a++)
        p[a] = n >> a & 1 ? f->high[a] : f->low[a];
    cwi_affine_apply(f->volume.affine[0], p, world);
}

/* Computes the world box of everything that is drawn. */
static void scene_box(const cwi_frame *f, double min[3], double max[3])
{
    double p[3];
    bool any = f->scene.mesh && cw_mesh_bounds(f->scene.mesh, min, max);
    for (int n = 0; f->volume.data && n < 8; n++, any = true) {
        box_corner(f, n, p);
        for (int a = 0; a < 3; a++) {
            min[a] = any ? fmin(min[a], p[a]) : p[a];
            max[a] = any ? fmax(max[a], p[a]) : p[a];
        }
    }
    for (int a = 0; a < 3 && !any; a++)
        min[a] = max[a] = 0;
}

static cw_status set_camera(cwi_frame *f, const double min[3], const double max[3],
                            cw_error *err)
{
    cw_scene *s = &f->scene;
    cw_camera *c = &s->camera;
    const double aspect = (double)s->width / (double)s->height;
    cw_fit_desc fit = {.aspect = aspect, .fov_deg = 30, .margin = 0.04};
    cw_status st = CW_OK;
    memcpy(fit.min, min, sizeof fit.min);
    memcpy(fit.max, max, sizeof fit.max);
    if (!is_camera_set(c))
        st = cw_camera_fit(&fit, c, err);
    if (st == CW_OK)
        st = cw_camera_axes(c, f->axes[0], f->axes[1], f->axes[2], err);
    if (st != CW_OK)
        return st;
    for (int a = 0; a < 3; a++)
        f->axes[2][a] = -f->axes[2][a];
    memcpy(f->eye_mm, c->eye, sizeof f->eye_mm);
    f->perspective = c->fov_deg > 0;
    f->half[1] =
        f->perspective ? tan(c->fov_deg * CWI_PI / 360) : c->height_mm / 2 / f->unit_mm;
    f->half[0] = f->half[1] * aspect;
    return CW_OK;
}

static void to_eye(const cwi_frame *f, const double world[3], double eye[3])
{
    double d[3];
    for (int a = 0; a < 3; a++)
        d[a] = (world[a] - f->eye_mm[a]) / f->unit_mm;
    for (int a = 0; a < 3; a++)
        eye[a] = cwi_dot(f->axes[a], d);
}

static void invert_affine(const double m[12], double inverse[12])
{
    double c[3][3];
    const double det = cwi_affine_determinant(m);
    cwi_affine_cofactor(m, c);
    for (int r = 0; r < 3; r++) {
        for (int s = 0; s < 3; s++)
            inverse[4 * r + s] = c[s][r] / det;
        inverse[4 * r + 3] =
            -(inverse[4 * r] * m[3] + inverse[4 * r + 1] * m[7] + inverse[4 * r + 2] * m[11]);
    }
}

static void set_matrices(cwi_frame *f)
{
    const double *a = f->volume.affine[0];
    double column[3], origin[3] = {a[3], a[7], a[11]}, eye[3];
    to_eye(f, origin, eye);
    for (int c = 0; c < 3; c++) {
        for (int r = 0; r < 3; r++)
            column[r] = a[4 * r + c] / f->unit_mm;
        for (int r = 0; r < 3; r++)
            f->eye_from_index[4 * r + c] = cwi_dot(f->axes[r], column);
    }
    for (int r = 0; r < 3; r++)
        f->eye_from_index[4 * r + 3] = eye[r];
    invert_affine(f->eye_from_index, f->index_from_eye);
}

static void set_depths(cwi_frame *f, const double min[3], const double max[3])
{
    double near = INFINITY, far = -INFINITY;
    for (int n = 0; n < 8; n++) {
        double p[3], eye[3];
        for (int a = 0; a < 3; a++)
            p[a] = n >> a & 1 ? max[a] : min[a];
        to_eye(f, p, eye);
        near = fmin(near, -eye[2]);
        far = fmax(far, -eye[2]);
    }
    const double size = fmax(far - near, 1e-3);
    f->near = near - 1e-3 * size;
    f->far = far + 1e-3 * size;
    if (f->perspective) {
        f->near = fmax(f->near, 1e-4 * size);
        f->far = fmax(f->far, 2 * f->near);
    }
}

static void set_cue(cwi_frame *f)
{
    const double *range = f->scene.cue_range;
    f->cue_start = (1 - range[0]) * f->near + range[0] * f->far;
    f->cue_end = (1 - range[1]) * f->near + range[1] * f->far;
    if (f->scene.cue_form == CW_CUE_EXPONENTIAL)
        f->cue_decay = -log1p(-(double)f->scene.depth_cue) / (f->cue_end - f->cue_start);
}

static cw_status set_clips(cwi_frame *f, cw_error *err)
{
    for (size_t n = 0; n < f->scene.clip_count; n++) {
        const cw_clip *c = &f->scene.clips[n];
        const double length = cwi_length(c->normal);
        if (!isnormal(length) || !isfinite(c->distance_mm))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "clip plane %zu: its normal is zero, or its distance is not finite",
                            n);
        for (int a = 0; a < 3; a++)
            f->clips[n][a] = cwi_dot(c->normal, f->axes[a]) / length;
        f->clips[n][3] = (c->distance_mm - cwi_dot(c->normal, f->eye_mm)) / length / f->unit_mm;
    }
    return CW_OK;
}

/* Finds the planes that leave some of the volume's box behind. Those in its sides do not count. */
static void find_faces(cwi_frame *f)
{
    static const double ROUNDING = 1e-3; /* in units of eye space */
    for (int c = 0; c < 8; c++) {
        double world[3], eye[3];
        box_corner(f, c, world);
        to_eye(f, world, eye);
        for (size_t n = 0; n < f->scene.clip_count; n++)
            if (cwi_dot(f->clips[n], eye) < f->clips[n][3] - ROUNDING)
                f->faces |= (uint32_t)1 << n;
    }
}

static void choose_unit(cwi_frame *f, const double min[3], const double max[3])
{
    if (!f->volume.data)
        f->unit_mm = cwi_distance(min, max) / MESH_UNITS;
    if (!isnormal(f->unit_mm))
        f->unit_mm = 1;
}

cw_status cwi_frame_init(cwi_frame *frame, const cw_scene *scene, cw_error *err)
{
    double min[3], max[3];
    cwi_frame *f = frame;
    *f = (cwi_frame){.scene = *scene,
                     .studio_light =
                         scene->light_count == 0 && !is_material_set(&scene->material)};
    cw_status st = resolve_scene(&f->scene, err);
    if (st == CW_OK)
        st = choose_reference(f, err);
    if (st == CW_OK && f->scene.mesh)
        st = cw_mesh_check(f->scene.mesh, err);
    if (st == CW_OK && draws_volume(f->scene.mode))
        st = take_volume(f, err);
    if (st != CW_OK)
        return st;
    scene_box(f, min, max);
    choose_unit(f, min, max);
    st = set_camera(f, min, max, err);
    if (st == CW_OK)
        st = set_clips(f, err);
    if (st == CW_OK && f->volume.data) {
        set_matrices(f);
        find_faces(f);
    }
    if (st == CW_OK)
        set_depths(f, min, max);
    if (st == CW_OK)
        set_cue(f);
    f->scene.width *= (size_t)f->scene.samples;
    f->scene.height *= (size_t)f->scene.samples;
    return st;
}

void cwi_frame_ray(const cwi_frame *f, double x, double y, double origin[3],
                   double direction[3])
{
    const double u = (2 * x / (double)f->scene.width - 1) * f->half[0];
    const double v = (1 - 2 * y / (double)f->scene.height) * f->half[1];
    if (f->perspective) {
        const double length = sqrt(u * u + v * v + 1);
        memset(origin, 0, 3 * sizeof *origin);
        direction[0] = u / length;
        direction[1] = v / length;
        direction[2] = -1 / length;
    } else {
        origin[0] = u;
        origin[1] = v;
        origin[2] = 0;
        direction[0] = direction[1] = 0;
        direction[2] = -1;
    }
}

void cwi_cut_interval(double at, double slope, double t[2])
{
    if (slope > 0)
        t[0] = fmax(t[0], -at / slope);
    else if (slope < 0)
        t[1] = fmin(t[1], -at / slope);
    else if (at < 0)
        t[1] = -INFINITY;
}

int cwi_frame_keep(const cwi_frame *f, const double origin[3], const double direction[3],
                   const double interval[2], double intervals[2][2])
{
    const double *t = interval;
    double kept[2] = {t[0], t[1]};
    for (size_t n = 0; n < f->scene.clip_count; n++)
        cwi_cut_interval(cwi_dot(f->clips[n], origin) - f->clips[n][3],
                         cwi_dot(f->clips[n], direction), kept);
    int count = 0;
    const bool away = f->scene.cut_away && f->scene.clip_count > 0;
    const double parts[2][2] = {{away ? t[0] : kept[0], away ? fmin(t[1], kept[0]) : kept[1]},
                                {fmax(t[0], kept[1]), t[1]}};
    if (away && !(kept[1] > kept[0])) { /* it misses the part that is cut away */
        memcpy(intervals[0], t, sizeof intervals[0]);
        return t[1] > t[0];
    }
    for (int n = 0; n < (away ? 2 : 1); n++)
        if (parts[n][1] > parts[n][0])
            memcpy(intervals[count++], parts[n], sizeof parts[n]);
    return count;
}

int cwi_frame_clip(const cwi_frame *f, const double origin[3], const double direction[3],
                   double intervals[2][2])
{
    double t[2] = {f->perspective ? f->near : -INFINITY, INFINITY};
    double index[3], slope[3];
    if (f->perspective) /* near is a plane */
        t[0] = f->near / -direction[2];
    cwi_affine_apply(f->index_from_eye, origin, index);
    for (int r = 0; r < 3; r++) {
        slope[r] = cwi_dot(f->index_from_eye + (size_t)4 * (size_t)r, direction);
        cwi_cut_interval(index[r] - f->low[r], slope[r], t);
        cwi_cut_interval(f->high[r] - index[r], -slope[r], t);
    }
    return cwi_frame_keep(f, origin, direction, t, intervals);
}

void cwi_frame_to_world(const cwi_frame *f, const double eye[3], double world[3])
{
    for (int a = 0; a < 3; a++)
        world[a] =
            f->eye_mm[a] + f->unit_mm * (eye[0] * f->axes[0][a] + eye[1] * f->axes[1][a] +
                                         eye[2] * f->axes[2][a]);
}

double cwi_frame_extinction(const cwi_frame *f, double opacity)
{
    return -log1p(-fmin(opacity, CWI_MAX_OPACITY)) / f->opacity_units;
}

bool cwi_frame_needs_gradients(const cwi_frame *f)
{
    return f->scene.lit || f->transfer.gradient_count > 0 ||
           f->scene.mode == CW_MODE_SHADED_TEXTURE;
}

double cwi_frame_surface_strength(const cwi_frame *f, double length)
{
    return f->surface > 0 ? fmin(length * f->surface, 1) : 1;
}

double cwi_frame_gradient_factor(const cwi_frame *f, double length)
{
    return cw_transfer_gradient_factor(&f->transfer, f->surface > 0
                                                         ? cwi_frame_surface_strength(f, length)
                                                         : length / f->unit_mm);
}

double cwi_frame_cue(const cwi_frame *f, double depth)
{
    const double fraction = (depth - f->cue_start) / (f->cue_end - f->cue_start);
    if (f->cue_decay > 0)
        return exp(-f->cue_decay * fmax(depth - f->cue_start, 0));
    return 1 - f->scene.depth_cue * fmin(fmax(fraction, 0), 1);
}

/* Computes the matrix of the gradient of f(index(eye)): the transpose of the map's
 * derivative. */
void cwi_frame_gradient_matrix(const cwi_frame *f, double m[3][3])
{
    for (size_t r = 0; r < 3; r++)
        for (size_t c = 0; c < 3; c++)
            m[r][c] = f->index_from_eye[4 * c + r];
}
