/* Lists words that people use and the names that they have here. Notes are honest about what
 * cubewright cannot do, and name what comes close. */
#include "cli/help/help_search.h"

#include <stddef.h>

const cli_synonym cli_synonyms[] = {
    {"threshold|level|contour|isolevel|isocontour|cutoff", "isovalue", "isovalue|--iso", NULL},
    {"hounsfield|hu|ct number", NULL, "hounsfield|--iso|--tf",
     "In CT volumes the isovalue is in Hounsfield units: a number, or bone, skin, soft, lung or "
     "metal."},
    {"decimat|reduc|low-poly|low poly|lowpoly|poly count|polycount|polygon count|face count",
     "simplify", "simplify|--triangles|--ratio|--error", NULL},
    {"lod|level of detail|levels of detail", NULL, "--lod", NULL},
    {"remesh|retopolog", NULL, "offset|--by|--snap",
     "'offset --by 0' makes a new mesh of the same surface; 'extract --snap' gives better "
     "triangles."},
    {"label|segment|mask|atlas", NULL, "--labels|--names|label|--inside",
     "'extract --labels all' makes a closed mesh of each label of a label map or a mask. An "
     "isovalue joins all labels above it."},
    {"denois|despeckl", NULL, "--denoise|smooth|--min-volume|--drop-components",
     "'extract --denoise' smooths the values of volumes, 'smooth' meshes. --min-volume and "
     "--drop-components remove small components."},
    {"smooth|filter|laplacian|taubin|gaussian|fairing|noisy", "smooth",
     "smooth|--denoise|--smooth-labels|--snap|--placement|--min-volume|--drop-components|--noise",
     "'smooth' and 'extract --smooth' smooth meshes, 'extract --denoise' the values of volumes, and "
     "'extract --labels' the surfaces of labels. --min-volume and --drop-components remove small components."},
    {"slice off|plane|base|halve|section", "cut", "--cut-plane", NULL},
    {"cavit|enclosed|hollow inside", "void", "--fill-voids|--min-volume", NULL},
    {"remesh|retriang|sliver|needle|fem|finite element|quality triangle", "remesh",
     "remesh|--fem|--edge|--adaptive|--snap", NULL},
    {"union|merge solid|subtract|difference|intersect|csg|carve|unite", "boolean",
     "boolean|--op|repair",
     "'boolean' unites, subtracts and intersects closed meshes, and unites the shells of one."},
    {"hole|heal|fix|mend|broken", "repair", "repair|--fill|--wrap|--weld", NULL},
    {"watertight|leak", "closed", "closed|repair|--open|--orient|--by|--profile",
     "'repair' closes broken meshes. 'extract' makes closed meshes, 'check' finds open edges, and "
     "'offset --by 0' rebuilds closed meshes that intersect themselves."},
    {"resampl|downsampl|upsampl|isotropic|interpol|subsampl|resolution|thin out", "resample",
     "--resample|--coarsen|--preview|--crop|--size",
     "--resample samples a volume at other distances. --coarsen uses every N-th voxel of each "
     "axis."},
    {"slice thickness|voxel size|pixel size|pixel spacing", "spacing", "--spacing|--voxel",
     NULL},
    {"roi|region of interest|subvolume|sub-volume|trim", "crop", "--crop|--clip-box|--clip",
     NULL},
    {"unit|scale|mm|millimet|inch|micron|micromet|metre|meter", "unit",
     "--input-unit|--unit|--source-unit|--spacing", NULL},
    {"axis|axes|orientation|lps|ras|z-up|y-up", "frame",
     "--input-frame|--input-up|--frame|--up|--axes|--letters", NULL},
    {"shell|wall|infill|lighten|thickness", "hollow", "hollow|--wall|--drain", NULL},
    {"dilat|erod|thicken|inflate|grow|expand|shrink", "offset", "offset|--by", NULL},
    {"flip|invert|inside out|inside-out", "orient", "--orient|--inside", NULL},
    {"island|speck|floater|debris|small parts|connected component", "components",
     "--min-volume|--drop-components", NULL},
    {"normal", NULL, "normals|--attributes|--shading", NULL},
    {"ct|cbct|pacs|scanner", NULL, "dicom|--gaps|--tilt|--tf", NULL},
    {"4d|time series|time-series|cine|gated|dynamic", "time steps",
     "--steps|--step|--animate|--pvd|--fps", NULL},
    {"colour map|color map|colormap|colourmap|lookup table|lut|palette", "transfer function",
     "transfer function|--tint", NULL},
    {"transparen|alpha|translucen|see-through", "opacity", "opacity|opacities|--color", NULL},
    {"volume render|volume rendering|ray cast|raycast|maximum intensity", "mode",
     "render|--mode", NULL},
    {"screenshot|snapshot|image", "picture", "picture|screenshot", NULL},
    {"video|movie|gif|mp4", NULL, "--turntable|--animate|--steps",
     "cubewright writes no videos. 'render --turntable' writes numbered pictures, 'extract "
     "--animate' an animated glTF file."},
    {"animation|spin", NULL, "--turntable|--orbit|--animate|turntable", NULL},
    {"rotat|turn", NULL, "--rotate|--up|--input-up|--turntable|--orbit", NULL},
    {"mirror|reflect", NULL, "--mirror|--input-frame|--frame",
     "A surface that comes out mirrored is in another frame than its reader expects: "
     "--input-frame says what the input has, and --frame what to write."},
    {"resum|continue|restart|checkpoint", NULL, "--skip-existing|--part|--config", NULL},
    {"quantiz|quantis|file size|smaller file|gzip|zip", "compress",
     "--compress|--tolerance|--bits|--effort", NULL},
    {"draco|meshopt", NULL, "--compress|--tolerance|--bits|--effort", NULL},
    {"ram|out of memory", "memory", "--memory|--max-voxels|--max-triangles", NULL},
    {"cpu|core|parallel|speed|fast|slow", "threads", "--threads|--preview|--accel|--progress",
     NULL},
    {"stl|obj|gltf|glb|ply|off|3mf|vtp|nifti|nrrd|tiff|vdb|openvdb|export|import|file type",
     NULL, "convert|formats|--format|--reader|--output", NULL},
    {"print|printer|3d print|slicer|resin", NULL, "print|hollow|--profile|--drain", NULL},
    {"quality|validate|verify|inspect|lint", "check", "check|--profile|--deep|--check", NULL},
    {"hausdorff|deviation|accuracy|precision", "distance",
     "distance|--error|--max-error|--source|--reference", NULL},
    {"gpu|opengl|headless|offscreen|off-screen", NULL, "--backend|--hidden|opengl", NULL},
    {NULL, NULL, NULL, NULL},
};
