/* The kinds of options that filter volumes, and smooth and cut surfaces. */
#ifndef CLI_INPUTS_FILTER_OPTIONS_H
#define CLI_INPUTS_FILTER_OPTIONS_H

#include "cli/framework/options.h"

extern const cli_kind cli_kind_resample, cli_kind_denoise, cli_kind_smoothing, cli_kind_plane;

#define CLI_RESAMPLE  (&cli_kind_resample) /* iso, 0.5mm, 1x1x2mm; then a kernel: 0.5mm:cubic */
#define CLI_DENOISE   (&cli_kind_denoise)  /* gauss:0.7vox, median:1, bilateral:1vox:30, nlm */
#define CLI_SMOOTHING (&cli_kind_smoothing) /* taubin, hc:20, fair:2vox */
#define CLI_PLANE     (&cli_kind_plane)     /* z=5mm, -z=10% of the box, 0,0,5:0,0.1,1 */

/* New distances between voxels. */
typedef struct cli_resample {
    bool given, iso; /* iso: the least of the old ones along every axis; else: */
    double mm[3];
    int kernel;       /* cw_kernel, of values */
    int label_kernel; /* cw_label_kernel */
    bool has_kernel;  /* one was typed */
    bool of_labels;   /* that was one of labels */
} cli_resample;

typedef enum cli_filter { CLI_GAUSS, CLI_MEDIAN, CLI_BILATERAL, CLI_ANISO, CLI_NLM } cli_filter;

/* A filter against noise. */
typedef struct cli_denoise {
    bool given;
    cli_filter filter;
    size_t count;     /* radius of a median in voxels, steps of diffusion */
    cli_length width; /* of a Gaussian or a bilateral filter: millimetres or voxels */
    double value;     /* width of values, contrast or noise; 0: from the data */
} cli_denoise;

/* How a surface is smoothed. */
typedef struct cli_smoothing {
    bool given;
    int method;        /* cw_smooth_method */
    size_t iterations; /* 0: the method's own */
    cli_length width;  /* of fair; not given: its own */
} cli_smoothing;

/* A plane, and the side of it that is kept. */
typedef struct cli_plane {
    bool given, is_percent; /* of the box along an axis */
    double point[3], normal[3];
    char text[96]; /* as it was typed */
} cli_plane;

/* Return these as they are typed, in static memory. */
const char *cli_resample_text(const cli_resample *resample);
const char *cli_denoise_text(const cli_denoise *denoise);
const char *cli_smoothing_text(const cli_smoothing *smoothing);
const char *cli_plane_text(const cli_plane *plane);

#endif
