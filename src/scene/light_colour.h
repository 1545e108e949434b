/* SPDX-License-Identifier: Apache-2.0
 *
 * The colour of a light whose strength is said in photometric units.
 */
#ifndef IGI_SRC_SCENE_LIGHT_COLOUR_H
#define IGI_SRC_SCENE_LIGHT_COLOUR_H

#include "scene/json.h"

/* By temperature, as a table of wavelengths and powers, as lines [nm, power], as chromaticity of CIE
 * 1931, or as people choose colours. */
#define IGI_LIGHT_COLOUR_KEYS "temperature_k", "spectrum", "lines", "xy", "hsv"

/* colour[bands], of luminance 1, white when nothing says it; *stated is the member that does. */
IGI_MUST_USE igi_status igi_light_read_colour(igi_context *ctx, const igi_json *at, int bands,
                                              double *colour, igi_json *stated);

/* Hue in degrees, saturation and value, as linear RGB. */
IGI_MUST_USE igi_status igi_json_hsv(igi_context *ctx, const igi_json *at, double rgb[3]);

#endif
