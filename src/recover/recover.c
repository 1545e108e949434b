/* SPDX-License-Identifier: Apache-2.0
 *
 * The whole way: photographs → observations → patches → albedo → materials.
 */
#include "recover/methods.h"

#include <string.h>

/* Patches are this share of the scene's diagonal: 1-2 % of the room's side (method of choice, by
 * the speed-accuracy chart). */
#define PATCH_SHARE 0.0105f

const char *igi_method_name(igi_method method)
{
    switch (method) {
    case IGI_METHOD_PATCHES: return "patches";
    case IGI_METHOD_GATHER: return "gather";
    case IGI_METHOD_RADIOSITY: return "radiosity";
    case IGI_METHOD_DIRECT: return "direct";
    }
    return "unknown";
}

bool igi_method_from_name(const char *name, igi_method *method)
{
    for (int m = IGI_METHOD_PATCHES; m <= IGI_METHOD_DIRECT; m++)
        if (strcmp(name, igi_method_name((igi_method)m)) == 0) {
            *method = (igi_method)m;
            return true;
        }
    return false;
}

void igi_recover_options_init(igi_recover_options *options)
{
    *options = (igi_recover_options){.struct_size = sizeof *options};
}
