#pragma once

namespace apriltrack {

/// Beyond where Student's distribution of so many degrees of freedom, 2 or more, has as much as the normal
/// one beyond `place` (Peizer and Pratt, JASA 63, 1968; of 2 within 1.1 %, of 4 and more within 0.4).
double student_place(double place, double degrees);

}  // namespace apriltrack
