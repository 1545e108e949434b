/* SPDX-License-Identifier: Apache-2.0
 *
 * A lamp's intensities by direction, for src/light/profile*.c alone.
 */
#ifndef IGI_SRC_LIGHT_PROFILE_H
#define IGI_SRC_LIGHT_PROFILE_H

#include "light/sky.h"

#define PROFILE_MOST_ANGLES 4096

struct profile {
    int verticals, horizontals;
    float *vertical, *horizontal; /* degrees, rising */
    float *candela;               /* [horizontals][verticals] */
};

/* Commas count as blanks. */
bool profile_number(const char **at, double *value);
/* Room for verticals x horizontals, which are set and in range. */
IGI_MUST_USE igi_status profile_allocate(igi_context *ctx, profile *p);

/* ANSI/IES LM-63: the text of a .ies file. */
IGI_MUST_USE igi_status profile_read_ies(igi_context *ctx, const char *path, const char *text,
                                         profile *p);
/* EULUMDAT: the text of a .ldt file. */
IGI_MUST_USE igi_status profile_read_ldt(igi_context *ctx, const char *path, const char *text,
                                         profile *p);

#endif
