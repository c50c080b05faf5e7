/* Volumes made ready for extraction: less noise, other distances between voxels. */
#ifndef CUBEWRIGHT_FILTER_H
#define CUBEWRIGHT_FILTER_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Options of all filters. Zero fields mean the default named beside them. */
typedef struct cw_filter_desc {
    uint32_t version;     /* 0: the first version of this struct */
    int threads;          /* default: all. The result is the same for any number */
    size_t max_bytes;     /* memory for the result and the work on it; default: no limit */
    cw_progress progress; /* default: none */
} cw_filter_desc;

/* Kernels for values between samples. */
typedef enum cw_kernel {
    CW_KERNEL_LINEAR, /* never leaves the range of the values around */
    CW_KERNEL_CUBIC,  /* through the samples, with continuous slopes [Keys1981] */
    CW_KERNEL_LANCZOS, /* of three lobes: sharper, with faint ripples beside edges [Duchon1979] */
    CW_KERNEL_COUNT
} cw_kernel;

/* Returns the name of a kernel, such as "linear"; static. NULL for an unknown one.
 * kernel  any number */
CW_API const char *cw_kernel_name(cw_kernel kernel);

/* Returns the type that means of a volume's values have: in cw_volume_gauss(), cw_volume_bilateral(),
 * cw_volume_aniso(), cw_volume_nlm() and cw_volume_resample(). Integers of 8 and 16 bits become
 * CW_F32, those of 32 bits CW_F64; floats keep their type, and so do labels (CW_KNOWN_LABELS), whose
 * means are rounded. All other filters keep the type.
 * volume  its type and what is known of it are read; borrowed. NULL: CW_F32 */
CW_API cw_type cw_filter_type(const cw_volume *volume);

/* Smooths the first component and step with a Gaussian. Voxels without a value (no data, not
 * finite) stay so, and the others are means of those that have one. Beyond the border values go
 * on as they are there. The scaling and the frame are kept; the type is cw_filter_type().
 * volume        an even grid; borrowed
 * sigma_voxels  standard deviation along each axis in voxels, 0 to 64; 0 leaves an axis as it is
 * desc          borrowed; NULL means all defaults
 * out           set to a volume that owns its voxels; free with cw_volume_free()
 * Returns       CW_ERR_ARGUMENT; CW_ERR_UNSUPPORTED for other grids; CW_ERR_LIMIT: max_bytes is too
 *               low; CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost          8 sigma + 1 products a voxel and axis */
CW_NODISCARD CW_API cw_status cw_volume_gauss(const cw_volume *volume,
                                              const double sigma_voxels[3],
                                              const cw_filter_desc *desc, cw_volume *out,
                                              cw_error *err);

/* Replaces each value of the first component and step by the median of a cube of voxels around.
 * Noise of single voxels goes, and flat edges stay where they are; what is thinner than half of
 * the cube goes as well. Voxels without a value stay so, and do not count; of an even number of
 * values the lower one in the middle is taken.
 * volume   an even grid; borrowed
 * radius   1 to 3: cubes of 3, 5 or 7 voxels
 * desc     borrowed; NULL means all defaults
 * out      set to a volume that owns its voxels; free with cw_volume_free()
 * Returns  as cw_volume_gauss()
 * Cost     about 150 comparisons a voxel for radius 1; 50 bits that change for 2, 98 for 3
 * Source   medians from the extremes that cannot be one, after [Smith1996] */
CW_NODISCARD CW_API cw_status cw_volume_median(const cw_volume *volume, size_t radius,
                                               const cw_filter_desc *desc, cw_volume *out,
                                               cw_error *err);

/* Estimates the noise of the first component and step: the standard deviation of a normal
 * distribution that is added to each voxel by itself. It is 1.4826 times the median of how far voxels
 * are from the mean of their six neighbours, which edges hardly change [Gasser1986]. Voxels whose
 * neighbours all have the same value do not count. Noise that neighbours share is underestimated.
 * volume   an even grid; borrowed
 * sigma    set to the estimate, in the unit of the values; 0: there is none
 * Returns  CW_ERR_ARGUMENT; CW_ERR_UNSUPPORTED for other grids; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_volume_noise(const cw_volume *volume, int threads,
                                              double *sigma, cw_error *err);

/* Replaces each value of the first component and step by a mean of those around, in which similar
 * values weigh more: noise goes, and edges stay. A voxel at the distance d with the difference v
 * weighs exp(-d^2 / (2 sigma_voxels^2) - v^2 / (2 sigma_value^2)), within 2.5 sigma_voxels.
 * volume        an even grid; borrowed
 * sigma_voxels  width in space along each axis in voxels, 0 to 4; 0 takes none along an axis
 * sigma_value   width of the values in their unit, less than half of the edges that matter; 0: 2.5
 *               times the noise as of cw_volume_noise()
 * desc          borrowed; NULL means all defaults
 * out           set to a volume that owns its voxels; free with cw_volume_free()
 * Returns       as cw_volume_gauss()
 * Cost          65 sigma^3 weights a voxel
 * Source        [Tomasi1998] */
CW_NODISCARD CW_API cw_status cw_volume_bilateral(const cw_volume *volume,
                                                  const double sigma_voxels[3],
                                                  double sigma_value,
                                                  const cw_filter_desc *desc, cw_volume *out,
                                                  cw_error *err);

/* Smooths the first component and step by diffusion along edges and not across: noise goes, also that
 * of the edge itself, and edges stay as steep as they are. Of the gradient of values, the part across
 * the edge flows exp(-(s / contrast)^2) as much as the rest, where s is the gradient of the smoothed
 * values, per shortest distance of voxels. Steps are stable for any distances between voxels.
 * volume    an even grid; borrowed
 * steps     1 to 100: each as long as a Gaussian of sqrt(2 / 7) voxels in cubes; 10 is usual
 * contrast  edges are steeper, in the unit of the values; 0: half of the noise as of
 *           cw_volume_noise(), as smoothing takes most of the noise
 * desc      borrowed; NULL means all defaults
 * out       set to a volume that owns its voxels; free with cw_volume_free()
 * Returns   as cw_volume_gauss()
 * Cost      three exponentials a voxel and step. A thread keeps eight slices of floats a step
 * Source    edge-enhancing diffusion [Weickert1998], with smoothing by 1/4, 1/2, 1/4 */
CW_NODISCARD CW_API cw_status cw_volume_aniso(const cw_volume *volume, size_t steps,
                                              double contrast, const cw_filter_desc *desc,
                                              cw_volume *out, cw_error *err);

/* Replaces each value of the first component and step by a mean of those in a cube, in which voxels
 * whose own neighbourhoods of 3 x 3 x 3 voxels look alike weigh more. Texture and edges stay.
 * volume   an even grid; borrowed
 * noise    standard deviation of the noise in the unit of the values; 0: as of cw_volume_noise()
 * radius   of the cube, 1 to 5 voxels of the shortest distance; 0: 3
 * desc     borrowed; NULL means all defaults
 * out      set to a volume that owns its voxels; free with cw_volume_free()
 * Returns  as cw_volume_gauss()
 * Cost     a weight and ten sums a voxel of the cube
 * Source   [Buades2005], [Coupe2008]; noise taken off as in [Buades2011] */
CW_NODISCARD CW_API cw_status cw_volume_nlm(const cw_volume *volume, double noise,
                                            size_t radius, const cw_filter_desc *desc,
                                            cw_volume *out, cw_error *err);

/* Samples the first component and step at other distances. The first voxel stays where it is; the
 * last is at most one new distance short of the old one. Where voxels become larger, kernels grow
 * with them, so that what is finer fades instead of becoming patterns. No data are where the
 * nearest sample has none.
 * volume      an even grid; a rectilinear one with CW_KERNEL_LINEAR, which becomes even; borrowed
 * spacing_mm  new distance along each axis; 0: as it is
 * kernel      between samples
 * desc        borrowed; NULL means all defaults
 * out         set to a volume that owns its voxels; free with cw_volume_free()
 * Returns     as cw_volume_gauss() */
CW_NODISCARD CW_API cw_status cw_volume_resample(const cw_volume *volume,
                                                 const double spacing_mm[3], cw_kernel kernel,
                                                 const cw_filter_desc *desc, cw_volume *out,
                                                 cw_error *err);

/* The values that are inside. */
typedef struct cw_inside {
    double level;       /* in the unit of the values; those at or above it are inside */
    bool inside_is_low; /* default: false; true: those below it are */
} cw_inside;

/* Makes voxels of the first component and step outside where a mask is 0, has no value or ends. They
 * become their mirror image at the level, so that the surface cuts midway between equal values, half a
 * voxel beside the mask. Voxels that are outside, and those in the mask, keep their bytes.
 * volume   an even grid; borrowed
 * mask     an even grid of any size and frame: its voxel next to the world point of a voxel counts;
 *          borrowed
 * inside   borrowed
 * desc     borrowed; NULL means all defaults
 * out      set to a volume that owns its voxels; free with cw_volume_free()
 * Returns  CW_ERR_ARGUMENT also if the type has no value on the other side of the level; as
 *          cw_volume_gauss() */
CW_NODISCARD CW_API cw_status cw_volume_mask(const cw_volume *volume, const cw_volume *mask,
                                             const cw_inside *inside,
                                             const cw_filter_desc *desc, cw_volume *out,
                                             cw_error *err);

/* Opens what is inside: removes what an ellipsoid does not fit into, such as thin bridges. Voxels
 * that change become their mirror image at the level; all others keep their bytes, so that the
 * surface elsewhere stays as it is. The border counts as neither side.
 * volume         an even grid; borrowed
 * radius_voxels  of the ellipsoid along each axis in voxels, 0 to 250. A voxel is in it whose center
 *                is
 * inside         borrowed
 * desc           borrowed; NULL means all defaults
 * out            set to a volume that owns its voxels; free with cw_volume_free()
 * Returns        as cw_volume_mask()
 * Cost           does not depend on the radius; 2 bytes a voxel besides the result
 * Source         exact Euclidean distances [Felzenszwalb2012] */
CW_NODISCARD CW_API cw_status cw_volume_open(const cw_volume *volume,
                                             const double radius_voxels[3],
                                             const cw_inside *inside,
                                             const cw_filter_desc *desc, cw_volume *out,
                                             cw_error *err);

/* Closes what is inside: fills what an ellipsoid does not fit into, such as cracks and pores. Beyond the
 * border is outside, so that the result stays in the convex hull of what was inside. The rest is as
 * in cw_volume_open(). Voxels without a value stay so.
 * volume         an even grid; borrowed
 * radius_voxels  of the ellipsoid along each axis in voxels, 0 to 250
 * inside         borrowed
 * desc           borrowed; NULL means all defaults
 * out            set to a volume that owns its voxels; free with cw_volume_free()
 * Returns        as cw_volume_mask()
 * Cost           2 bytes a voxel of the box around what is inside, with the radius at each side */
CW_NODISCARD CW_API cw_status cw_volume_close(const cw_volume *volume,
                                              const double radius_voxels[3],
                                              const cw_inside *inside,
                                              const cw_filter_desc *desc, cw_volume *out,
                                              cw_error *err);

/* Finds the box of voxels that are inside, in the first component and step. With a margin of 1 or more
 * the part of the volume in it has the same surface as the whole.
 * volume   an even or rectilinear grid; borrowed
 * inside   borrowed
 * margin   voxels to add at each side, as far as the volume has them
 * box      set on success; for cw_volume_crop()
 * Returns  CW_ERR_EMPTY: no voxel is inside; CW_ERR_ARGUMENT; CW_ERR_UNSUPPORTED for other grids;
 *          CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_volume_inside_box(const cw_volume *volume,
                                                   const cw_inside *inside, size_t margin,
                                                   int threads, cw_box *box, cw_error *err);

/* Removes the table of a CT, and what else lies beside the body: they become air of -1000 HU. The body
 * is the largest component above -300 HU. What touches it goes if it is thinner than 10 mm and has more
 * than 40 ml, as the shell of a table or of a holder. Arms that the slices do not connect with the body
 * go, too. Cavities are filled in each slice of the third axis, so lungs and airways stay. The body
 * keeps its bytes, and so do two voxels around it that are below -300 HU: its surface stays where it
 * is. Where a table touches the body, what is thicker than 10 mm together with it stays.
 * volume       an even grid, in Hounsfield units; borrowed
 * desc         borrowed; NULL means all defaults
 * out          set to a volume that owns its voxels; free with cw_volume_free()
 * removed_mm3  set to the volume above -300 HU that was removed; may be NULL
 * Returns      CW_ERR_EMPTY: nothing above -300 HU is thicker than 10 mm; CW_ERR_UNSAFE: more than a
 *              third of the largest component would go, which then is no body; as cw_volume_gauss()
 * Cost         3 bytes a voxel besides the result, and the runs of voxels along x */
CW_NODISCARD CW_API cw_status cw_volume_remove_table(const cw_volume *volume,
                                                     const cw_filter_desc *desc, cw_volume *out,
                                                     double *removed_mm3, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
