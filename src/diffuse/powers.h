/* SPDX-License-Identifier: Apache-2.0
 *
 * Powers of lights that nobody gave and no photograph shows, solved with the albedos.
 *
 * Over a region of one albedo, what leaves is in proportion to what arrives. With t_r = 1 / rho_r,
 *     pi L_c t_r = K_c + sum_l p_l G_cl         for each cell c of region r, per band:
 * L is photographed; K, what the known lights send and what surfaces reflect, is gathered from the
 * photographs, hence known absolutely, and with it the scale of the p_l; G is geometry. The t_r are
 * eliminated.
 *
 * A cell counts by how well its region follows the equation at all: a textured or glossy region
 * does so badly, and counts little without having been told apart. A light that is determined by
 * nothing keeps what is a guess (an albedo of about a half where it shines), with a standard
 * deviation that says so.
 */
#ifndef IGI_SRC_DIFFUSE_POWERS_H
#define IGI_SRC_DIFFUSE_POWERS_H

#include "diffuse/region_sums.h"

typedef struct igi_powers igi_powers;

/* Is there a light whose value is solved? */
bool igi_powers_are_wanted(const igi_problem *problem);

/* *powers: NULL when every light's value is known. */
IGI_MUST_USE igi_status igi_powers_create(igi_context *ctx, const igi_problem *problem,
                                          const igi_rows *rows, const igi_places *places,
                                          igi_powers **powers);
void igi_powers_destroy(igi_powers *powers);

/* One step: from places->irradiance, which holds what all lights give with their present values,
 * to new values in problem->lights. Returns the largest relative change. */
double igi_powers_step(igi_powers *powers, const igi_places *places);

/* Standard deviations of the values and, by them, of the albedos (diffuse->albedo_std must be there
 * already), and sentences about what cannot be told apart. Does nothing with NULL. */
IGI_MUST_USE igi_status igi_powers_finish(igi_context *ctx, igi_powers *powers,
                                          const igi_places *places, igi_diffuse *diffuse);

#endif
