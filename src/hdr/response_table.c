/* SPDX-License-Identifier: Apache-2.0
 *
 * The table of the space of known responses (Grossberg and Nayar's invemor.txt).
 */
#include "base/context.h"
#include "hdr/hdr.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Reads the IGI_HDR_TABLE numbers that follow the next '='. */
static bool read_section(FILE *file, double values[IGI_HDR_TABLE])
{
    int c;
    while ((c = getc(file)) != EOF && c != '=') {}
    if (c == EOF) return false;
    for (int i = 0; i < IGI_HDR_TABLE; i++)
        if (fscanf(file, "%lf", &values[i]) != 1 || !(fabs(values[i]) < 100)) return false;
    return true;
}

igi_status igi_hdr_load_basis(igi_context *ctx, const char *path, double (**table)[IGI_HDR_TABLE])
{
    double domain[IGI_HDR_TABLE];
    igi_status status = IGI_OK;
    *table = NULL;
    FILE *file = fopen(path, "r");
    if (!file)
        return igi_fail(ctx, errno == ENOENT ? IGI_E_DATA : IGI_E_SYSTEM,
                        "%s: cannot be opened (%s); check the name and the permissions", path,
                        strerror(errno));
    status = IGI_ALLOC(ctx, IGI_HDR_COMPONENTS + 1, table);
    bool good = status == IGI_OK && read_section(file, domain) && domain[0] == 0 &&
                domain[IGI_HDR_TABLE - 1] == 1;
    for (int k = 0; good && k <= IGI_HDR_COMPONENTS; k++) good = read_section(file, (*table)[k]);
    good = good && fabs((*table)[0][0]) < 1e-6 && fabs((*table)[0][IGI_HDR_TABLE - 1] - 1) < 1e-6;
    for (int k = 1; good && k <= IGI_HDR_COMPONENTS; k++)
        good = fabs((*table)[k][0]) < 1e-6 && fabs((*table)[k][IGI_HDR_TABLE - 1]) < 1e-6;
    /* Photographs are brighter than the light in them: a mean above the diagonal is of emor.txt. */
    good = good && (*table)[0][IGI_HDR_TABLE / 2] < .5;
    fclose(file);
    if (status == IGI_OK && !good)
        status = igi_fail(ctx, IGI_E_DATA,
                          "%s: no table of inverse responses (B, g0, hinv(1) .. of %d numbers "
                          "each); give the EMoR model's invemor.txt",
                          path, IGI_HDR_TABLE);
    if (status != IGI_OK) {
        igi_free(*table);
        *table = NULL;
    }
    return status;
}
