/* SPDX-License-Identifier: Apache-2.0
 *
 * OpenCV's responses and merges of brackets behind C.
 */
#include "bridge/guarded.hh"
#include "bridge/opencv.h"

#include <opencv2/photo.hpp>

#include <cstring>
#include <vector>

namespace
{

std::vector<cv::Mat> photos_of(const igi_cv_bracket *bracket)
{
    std::vector<cv::Mat> photos;
    for (size_t i = 0; i < bracket->count; i++)
        photos.emplace_back(bracket->height, bracket->width, CV_8UC3,
                            const_cast<uint8_t *>(bracket->photos[i]));
    return photos;
}

std::vector<float> times_of(const igi_cv_bracket *bracket)
{
    return std::vector<float>(bracket->times_s, bracket->times_s + bracket->count);
}

} // namespace

igi_status igi_cv_response(igi_context *ctx, const igi_cv_bracket *bracket, bool robertson,
                           float *response)
{
    return igi::guarded(ctx, "response", [&] {
        cv::Ptr<cv::CalibrateCRF> method;
        if (robertson) method = cv::createCalibrateRobertson();
        else method = cv::createCalibrateDebevec();
        cv::Mat result;
        method->process(photos_of(bracket), result, times_of(bracket));
        for (int z = 0; z < 256; z++)
            for (int c = 0; c < 3; c++) response[3 * z + c] = result.at<cv::Vec3f>(z)[c];
    });
}

igi_status igi_cv_merge(igi_context *ctx, const igi_cv_bracket *bracket, const float *response,
                        bool robertson, float *radiance)
{
    return igi::guarded(ctx, "merge", [&] {
        const cv::Mat curve(256, 1, CV_32FC3, const_cast<float *>(response));
        cv::Ptr<cv::MergeExposures> method;
        if (robertson) method = cv::createMergeRobertson();
        else method = cv::createMergeDebevec();
        cv::Mat result;
        method->process(photos_of(bracket), result, times_of(bracket), curve);
        const cv::Mat whole = result.isContinuous() ? result : result.clone();
        std::memcpy(radiance, whole.ptr<float>(),
                    size_t(bracket->width) * size_t(bracket->height) * 3 * sizeof(float));
    });
}
