#pragma once

using Function = void (*)();

Function first_unit();
Function second_unit();
