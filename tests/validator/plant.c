/* Writes every planted mesh as NAME.stl into a folder, and prints the names: for other people's
 * checkers. */
#include "support/planted.h"

#include <stdio.h>

int main(int count, char **words)
{
    if (count != 2)
        return 2;
    for (size_t n = 0; n < test_planted_count; n++) {
        char path[4096];
        cw_error err = {0};
        cw_mesh mesh = test_plant(&test_planted_meshes[n]);
        snprintf(path, sizeof path, "%s/%s.stl", words[1], test_planted_meshes[n].name);
        const cw_status st = cw_mesh_write(path, &mesh, NULL, &err);
        cw_mesh_free(&mesh);
        if (st != CW_OK) {
            fprintf(stderr, "%s\n", err.message);
            return 1;
        }
        puts(test_planted_meshes[n].name);
    }
    return 0;
}
