// What the start of any process takes.
int main() {}
