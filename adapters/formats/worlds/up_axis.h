#pragma once

namespace prospect {

/// The axis of a file's own coordinates that points up.
enum class UpAxis { kX, kY, kZ };

}  // namespace prospect
