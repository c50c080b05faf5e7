/* Lists the optional features: availability, and the reason for each that is missing. */
#include "core/base/features.h"

#include "core/base/module.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { MAX_FEATURES = 32, REASON_BYTES = 128 };

static cw_feature features[MAX_FEATURES];
static char file_is_missing[MAX_FEATURES][REASON_BYTES];
static pthread_once_t features_once = PTHREAD_ONCE_INIT;

/* Fills the list at run time, since a package may leave out a module that was built. */
static void fill_features(void)
{
    for (size_t i = 0; i < cwi_feature_row_count && i < MAX_FEATURES; i++) {
        const cwi_feature_row *row = &cwi_feature_rows[i];
        cw_feature *f = &features[i];
        *f = (cw_feature){.name = row->name, .about = row->about, .reason = row->reason};
        if (!*row->reason && *row->module && !cwi_module_present(row->module)) {
            snprintf(file_is_missing[i], REASON_BYTES,
                     "the file cubewright-%s.so is not beside the library (Debian: %s)",
                     row->module, row->shipped);
            f->reason = file_is_missing[i];
        }
        f->available = !*f->reason;
    }
}

const cw_feature *cw_features(size_t *count)
{
    pthread_once(&features_once, fill_features);
    *count = cwi_feature_row_count < MAX_FEATURES ? cwi_feature_row_count : MAX_FEATURES;
    return features;
}

const cw_feature *cwi_find_feature(const char *name)
{
    size_t count;
    const cw_feature *all = cw_features(&count);
    for (size_t i = 0; i < count; i++)
        if (strcmp(all[i].name, name) == 0)
            return &all[i];
    return NULL;
}
