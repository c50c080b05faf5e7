/* The optional parts of a build, one row each; CMake makes the rows (core/features.cmake). */
#ifndef CORE_BASE_FEATURES_H
#define CORE_BASE_FEATURES_H

#include "core/base/status.h"

typedef struct cwi_feature_row {
    const char *name;     /* as printed by `version --features` */
    const char *about;    /* benefit of the feature */
    const char *module;   /* the module that contains it; "" for a part of the library itself */
    const char *shipped;  /* our Debian package with the module */
    const char *option;   /* name of the CMake option */
    const char *packages; /* Debian packages, separated by spaces */
    const char *licences; /* the libraries it links, each with its licence in brackets */
    const char *reason;   /* why the feature was not built; "" when it was */
} cwi_feature_row;

extern const cwi_feature_row cwi_feature_rows[];
extern const size_t cwi_feature_row_count;
extern const char cwi_needed_licences[]; /* of the libraries that no build is without */

/* Finds a feature by its name, such as "gltf"; NULL when the name is unknown. */
const cw_feature *cwi_find_feature(const char *name);

#endif
