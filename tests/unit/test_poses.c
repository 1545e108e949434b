/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras that recovery registers by itself stay moved only where edges come twice as near.
 */
#include "test.h"

#include "recover/poses.h"

#define FRAMES 3

/* How many of three cameras stay moved whose edges lay .4 px off, and then so far; `all`: how far all
 * together then. */
static int moved(const double after[FRAMES], bool all, double together)
{
    igi_frame given[FRAMES] = {{0}}, found[FRAMES] = {{0}};
    igi_registered_frame frames[FRAMES] = {{0}};
    igi_registered registered = {
        .frames = frames, .frame_count = FRAMES, .before_px = .4, .after_px = together};
    igi_scene scene = {.frames = given, .frame_count = FRAMES};
    igi_poses poses = {.scene = {.frames = found, .frame_count = FRAMES},
                       .registered = &registered};
    int count = 0;
    for (int i = 0; i < FRAMES; i++) {
        given[i].camera.cx = 1, found[i].camera.cx = 2;
        frames[i].moved = true;
        frames[i].before_px = .4, frames[i].after_px = after[i], frames[i].moved_px = .5;
    }
    igi_poses_keep_unconvincing(&scene, all, &poses);
    for (int i = 0; i < FRAMES; i++) {
        bool stays = frames[i].moved;
        count += stays;
        CHECK(found[i].camera.cx == (stays ? 2 : 1));
        CHECK(frames[i].after_px == (stays ? after[i] : .4));
        CHECK(frames[i].moved_px == (stays ? .5 : 0));
    }
    return count;
}

static void each_must_convince(void)
{
    CHECK(moved((const double[]){.19, .21, .1}, false, .3) == 2);
    CHECK(moved((const double[]){.3, .3, .3}, false, .1) == 0);
}

/* Single cameras whose edges hardly came nearer move with the others. */
static void all_together_must_convince(void)
{
    CHECK(moved((const double[]){.05, .3, .1}, true, .19) == 3);
    CHECK(moved((const double[]){.05, .05, .4}, true, .21) == 0);
}

TEST_MAIN({"each_must_convince", each_must_convince},
          {"all_together_must_convince", all_together_must_convince})
