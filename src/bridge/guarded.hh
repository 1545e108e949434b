// SPDX-License-Identifier: Apache-2.0
//
// OpenCV's exceptions become statuses. For src/bridge/opencv*.cc.
#ifndef IGI_SRC_BRIDGE_GUARDED_HH
#define IGI_SRC_BRIDGE_GUARDED_HH

extern "C" {
#include "base/context.h"
}

#include <opencv2/core.hpp>

#include <new>

namespace igi
{

// OpenCV prints errors before it throws them; the sentence says enough.
inline int say_nothing(int, const char *, const char *, const char *, int, void *)
{
    return 0;
}

// Runs the body; every exception becomes a status.
template <class Body> igi_status guarded(igi_context *ctx, const char *what, Body body)
{
    try {
        cv::redirectError(say_nothing);
        cv::setNumThreads(igi_threads(ctx));
        body();
        return IGI_OK;
    } catch (const std::bad_alloc &) {
        return igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory; use fewer or smaller photographs", what);
    } catch (const std::exception &e) {
        return igi_fail(ctx, IGI_E_NO_ANSWER, "%s: OpenCV gave up (%.200s); check the input", what,
                        e.what());
    } catch (...) {
        return igi_fail(ctx, IGI_E_INTERNAL, "%s: OpenCV threw what it should not; report this",
                        what);
    }
}

} // namespace igi

#endif
