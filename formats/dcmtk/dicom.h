/* Facts of a DICOM file, which the module "dicom" (DCMTK, in a sandboxed process) puts into the
 * shared memory. Nothing in here has been checked. Nothing identifies a patient: neither name
 * nor number nor date is ever taken out of a file. */
#ifndef FORMATS_DCMTK_DICOM_H
#define FORMATS_DCMTK_DICOM_H

#include "formats/volume/sandboxed_planes.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Attributes that may distinguish frames at one place, the most reliable first. */
enum {
    CWI_DICOM_INCREMENT, /* rank by the vectors of FrameIncrementPointer, or by DimensionIndexValues */
    CWI_DICOM_TEMPORAL,  /* TemporalPositionIdentifier, TemporalPositionIndex */
    CWI_DICOM_REFERENCE, /* FrameReferenceTime */
    CWI_DICOM_TRIGGER,   /* TriggerTime, NominalCardiacTriggerDelayTime */
    CWI_DICOM_PHASE,     /* NominalPercentageOfCardiacPhase, ...OfRespiratoryPhase */
    CWI_DICOM_ECHO,      /* EchoTime */
    CWI_DICOM_B_VALUE,   /* DiffusionBValue */
    CWI_DICOM_ACQUISITION,
    CWI_DICOM_KEYS
};

typedef enum cwi_dicom_has {
    CWI_DICOM_POSITION = 1,
    CWI_DICOM_ORIENTATION = 2,
    CWI_DICOM_SPACING = 4,
    CWI_DICOM_BETWEEN = 8,
    CWI_DICOM_RESCALED = 16,  /* to Hounsfield units, if it is a CT */
    CWI_DICOM_OWN_FRAME = 32, /* places are those of a volume, not of the patient */
    CWI_DICOM_NUMBERED =
        64 /* position is that of slice 0: this one stands slice * between mm along the
                                 normal from it; between is 0 where that is not known */
} cwi_dicom_has;

typedef struct cwi_dicom_frame {
    double position[3]; /* of the first pixel's centre, mm, LPS */
    double axes[2][3];  /* directions along a row (to the next column) and along a column */
    double spacing[2];  /* mm between columns, between rows */
    double
        between; /* SpacingBetweenSlices, with the sign that is stated, else SliceThickness */
    double slope, intercept;
    double keys[CWI_DICOM_KEYS]; /* NaN: not stated */
    uint32_t has;                /* cwi_dicom_has */
    int32_t slice;               /* with CWI_DICOM_NUMBERED */
    uint32_t segment;            /* of a segmentation: the segment's number */
    char stack[20];              /* StackID: frames of different ones make no volume together */
} cwi_dicom_frame;

typedef enum cwi_dicom_kind {
    CWI_DICOM_NO_IMAGE, /* a directory, a report, ... */
    CWI_DICOM_IMAGE,
    CWI_DICOM_SEGMENTATION, /* a frame holds the mask of one segment */
    CWI_DICOM_LABELMAP,     /* a pixel is the number of a segment */
    CWI_DICOM_FRACTIONS     /* a frame holds the fractions of one segment: from 0 to 1 */
} cwi_dicom_kind;

typedef struct cwi_dicom_facts {
    cwi_dicom_kind kind;
    char series[72], instance[72], modality[20];
    char refusal[160];   /* the reason why its pixels are not read; empty: they
                                        are */
    char no_volume[160]; /* the reason why several frames of its kind make no
                                        volume; empty: they may */
    char order[96];      /* names of the vectors that CWI_DICOM_INCREMENT ranks by */
    int64_t number, instance_number; /* SeriesNumber; INT64_MIN: none */
    uint32_t columns, rows, samples, frame_count;
    cw_type type;         /* of the returned pixels */
    uint32_t value_bits;  /* bits that their values take, the sign counted */
    cw_type stored_type;  /* of the pixels in the file */
    uint64_t pixel_bytes; /* of the stored pixels; 0: compressed */
    bool deflated;        /* the whole file is deflated */
    bool has_padding;
    double padding[2];
    uint32_t segment_count; /* of a segmentation */
    bool never_overlaps;    /* it states that its segments do not overlap */
} cwi_dicom_facts;          /* frame_count frames follow, then segment_count segments */

/* A word of a coding scheme. Texts are as the file has them. */
typedef struct cwi_dicom_code {
    char scheme[20], value[20], meaning[260];
} cwi_dicom_code;

/* A segment of a segmentation. */
typedef struct cwi_dicom_segment {
    uint32_t number, has_color;
    uint16_t lab[3]; /* RecommendedDisplayCIELabValue */
    char label[260];
    cwi_dicom_code category, type;
} cwi_dicom_segment;

/* The size that an image within DICOM must have. */
typedef struct cwi_dicom_image {
    uint32_t columns, rows, samples;
    cw_type type;
} cwi_dicom_image;

/* Decodes JPEG 2000: the pixels of one image, interleaved, as numbers of the type.
 * Returns CW_ERR_FORMAT for one that is damaged or has another size, CW_ERR_UNSUPPORTED,
 * CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_dicom_jpeg2000(const void *data, size_t size,
                                          const cwi_dicom_image *image, void *pixels,
                                          cw_error *err);

extern CW_API const cwi_plane_functions cwi_module_dicom;

#ifdef __cplusplus
}
#endif

#endif
