"""What is wrong with records, said before anything long starts: each check a function of what is seen, giving findings."""
