/* Writes a growing sphere as VTP files and the .pvd that lists them into a folder, for other
 * people's readers. */
#include "support/support.h"

#include <stdio.h>

enum { STEPS = 3 };

static cw_status write_step(const char *path, double isovalue, cw_error *err)
{
    const cw_field_desc desc = {.field = CW_FIELD_SPHERE, .dim = {24, 24, 24}, .type = CW_F32};
    cw_volume v;
    cw_mesh mesh = {0};
    cw_status st = cw_field_sample(&desc, &v, err);
    if (st == CW_OK)
        st = cw_extract(&v, &(cw_extract_desc){.isovalue = isovalue}, &mesh, NULL, err);
    if (st == CW_OK)
        st = cw_mesh_write(path, &mesh, NULL, err);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
    return st;
}

int main(int count, char **words)
{
    static char paths[STEPS][4096];
    char pvd[4096];
    cw_pvd_entry entries[STEPS];
    cw_error err = {0};
    cw_status st = CW_OK;
    if (count != 2)
        return 2;
    for (int i = 0; i < STEPS && st == CW_OK; i++) {
        snprintf(paths[i], sizeof paths[i], "%s/steps/%04d.vtp", words[1], i);
        entries[i] = (cw_pvd_entry){paths[i], 0.25 * i};
        st = write_step(paths[i], 2.0 - i, &err);
    }
    snprintf(pvd, sizeof pvd, "%s/run.pvd", words[1]);
    if (st == CW_OK)
        st = cw_pvd_write(pvd, entries, STEPS, NULL, &err);
    if (st != CW_OK)
        fprintf(stderr, "%s\n", err.message);
    return st != CW_OK;
}
